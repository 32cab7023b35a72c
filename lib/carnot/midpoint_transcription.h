// The direct midpoint transcription of a boundary-value problem, interval by interval.
//
// With qm = (q0 + q1)/2, v = (q1 - q0)/h and F_d = h [L - lambda.G v](qm, v), a path that makes
// sum F_d stationary subject to G(qm) v = 0 satisfies exactly the midpoint rule on the index-1
// Hamiltonian system (Marsden & West, Acta Numerica 2001, discrete Legendre transform):
//
//   p0 = -D1 F_d = F_v - h F_q / 2,      p1 = D2 F_d = F_v + h F_q / 2,
//
// so a relaxation of the path needs no guess of p0 and yields a discrete costate. Rows of G that
// are dependent leave lambda undetermined: a scene that has such says by a projector P(q) =
// gauge(q) along which, and -lambda'P lambda/2 is added to L, which makes P lambda = 0.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

#include "carnot/cholesky.h"
#include "carnot/gradient.h"
#include "carnot/velocity_constraints.h"

namespace carnot {

// Least-squares form of one interval at (qm, v): |r|^2/2 = v'M v/2 + gamma |G v|^2/2 with gamma as
// in the multiplier route (so that singular M is allowed too), c = G v, and V.
template <class T, int n, int k>
struct MidpointTerms {
  Vector<T, n> r;
  Vector<T, k> c;
  T potential;
};

template <class Scene, class T>
[[nodiscard]] bool midpoint_terms(const VelocityConstraints<Scene>& system,
                                  const Vector<T, Scene::kDof>& qm,
                                  const Vector<T, Scene::kDof>& v,
                                  MidpointTerms<T, Scene::kDof, Scene::kMultipliers>& out) {
  using std::sqrt;
  constexpr int n = Scene::kDof;
  const Matrix<T, n, n> mass = system.regular_mass(qm);
  Matrix<T, n, n> lower;
  Vector<T, n> pivots;
  if (!cholesky_factor(mass, lower, pivots)) return false;
  for (int i = 0; i < n; ++i) {  // r = D^(1/2) L' v
    T sum = v[i];
    for (int j = i + 1; j < n; ++j) sum += lower(j, i) * v[j];
    out.r[i] = sqrt(pivots[i]) * sum;
  }
  out.c = system.constraint(qm, v);
  out.potential = system.potential(qm);
  return true;
}

template <class S>
concept HasGauge = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.gauge(q) } -> std::convertible_to<Matrix<double, S::kMultipliers, S::kMultipliers>>;
};

// P(q) lambda.
template <HasGauge Scene, class T>
Vector<T, Scene::kMultipliers> gauge_part(const Scene& scene,
                                          const Vector<T, Scene::kDof>& q,
                                          const Vector<double, Scene::kMultipliers>& lambda) {
  Vector<T, Scene::kMultipliers> l;
  for (int i = 0; i < Scene::kMultipliers; ++i) l[i] = constant<T>(lambda[i]);
  return product(scene.gauge(q), l);
}

// First and, where asked for, second derivatives of l(q, v) = L - lambda.G v - lambda'P lambda/2 at
// fixed lambda.
template <int n, int k>
struct AugmentedLagrangian {
  Vector<double, n> l_q;
  Vector<double, n> l_v;  // M v - G' lambda, the momentum
  Vector<double, k> g;    // G v + P lambda
  Matrix<double, n, n> l_qq;
  Matrix<double, n, n> l_vq;  // row: v, column: q
  Matrix<double, n, n> l_vv;  // M
  Matrix<double, k, n> g_q;
  Matrix<double, k, n> g_v;  // G
};

// l is quadratic in v, so Jets are needed in the n directions of q only, nested for l_qq alone.
template <class Scene>
void augmented_lagrangian(const VelocityConstraints<Scene>& system,
                          const Vector<double, Scene::kDof>& q,
                          const Vector<double, Scene::kDof>& v,
                          const Vector<double, Scene::kMultipliers>& lambda,
                          bool second,
                          AugmentedLagrangian<Scene::kDof, Scene::kMultipliers>& out) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  const auto value = [&](const auto& x) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    Vector<T, n> velocity;
    for (int i = 0; i < n; ++i) velocity[i] = constant<T>(v[i]);
    T sum = system.lagrangian(x, velocity);
    const Vector<T, k> g = system.constraint(x, velocity);
    for (int i = 0; i < k; ++i) sum -= constant<T>(lambda[i]) * g[i];
    if constexpr (HasGauge<Scene>) {
      const Vector<T, k> kept = gauge_part(system.scene(), x, lambda);
      for (int i = 0; i < k; ++i) sum -= constant<T>(0.5 * lambda[i]) * kept[i];
    }
    return sum;
  };
  const auto rows = [&](const auto& x, const auto& velocity) {
    using T = typename std::decay_t<decltype(x)>::Scalar;
    Vector<T, k> g = system.constraint(x, velocity);
    if constexpr (HasGauge<Scene>) g += gauge_part(system.scene(), x, lambda);
    return g;
  };
  if (!second) {
    out.l_q = gradient(value, q);
    out.l_v = system.momentum(q, v, lambda);
    out.g = rows(q, v);
    return;
  }
  using J = Jet<double, n>;
  const Vector<J, n> x = seeded(q);
  const Vector<J, n> vj = unseeded<J>(v);
  const Vector<J, n> l_q = gradient(value, x);
  const Vector<J, n> l_v = system.momentum(x, vj, Vector<J, k>(unseeded<J>(lambda)));
  const Vector<J, k> g = rows(x, vj);
  for (int i = 0; i < n; ++i) {
    out.l_q[i] = l_q[i].a;
    out.l_v[i] = l_v[i].a;
    out.l_qq.row(i) = l_q[i].v.transpose();
    out.l_vq.row(i) = l_v[i].v.transpose();
  }
  for (int i = 0; i < k; ++i) {
    out.g[i] = g[i].a;
    for (int j = 0; j < n; ++j) out.g_q(i, j) = g[i].v[j];
  }
  out.l_vv = system.scene().mass(q);
  out.g_v = system.scene().constraints(q);
}

// Gradient and, unless null, Hessian of the discrete Lagrangian F_d(q0, q1, lambda) = h l(qm, v)
// with respect to x = (q0, q1, lambda), m = 2n + k. The chain rule with d qm = (dq0 + dq1)/2 and
// d v = (dq1 - dq0)/h.
template <class Scene>
void discrete_lagrangian(
    const VelocityConstraints<Scene>& system,
    double h,
    const Vector<double, 2 * Scene::kDof + Scene::kMultipliers>& x,
    Vector<double, 2 * Scene::kDof + Scene::kMultipliers>& gradient_out,
    Matrix<double, 2 * Scene::kDof + Scene::kMultipliers, 2 * Scene::kDof + Scene::kMultipliers>*
        hessian) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  const Vector<double, n> q0 = x.template head<n>();
  const Vector<double, n> q1 = x.template segment<n>(n);
  AugmentedLagrangian<n, k> l;
  augmented_lagrangian(system,
                       Vector<double, n>(0.5 * (q0 + q1)),
                       Vector<double, n>((q1 - q0) / h),
                       Vector<double, k>(x.template tail<k>()),
                       hessian != nullptr,
                       l);
  gradient_out << 0.5 * h * l.l_q - l.l_v, 0.5 * h * l.l_q + l.l_v, -h * l.g;
  if (hessian == nullptr) return;
  const Matrix<double, n, n> symmetric = 0.5 * (l.l_vq + l.l_vq.transpose());
  const Matrix<double, n, n> skew = 0.5 * (l.l_vq.transpose() - l.l_vq);
  const Matrix<double, n, n> position = 0.25 * h * l.l_qq;
  const Matrix<double, n, n> velocity = l.l_vv / h;
  hessian->setZero();
  hessian->template block<n, n>(0, 0) = position - symmetric + velocity;
  hessian->template block<n, n>(n, n) = position + symmetric + velocity;
  hessian->template block<n, n>(0, n) = position + skew - velocity;
  hessian->template block<n, n>(n, 0) = hessian->template block<n, n>(0, n).transpose();
  hessian->template block<k, n>(2 * n, 0) = l.g_v - 0.5 * h * l.g_q;
  hessian->template block<k, n>(2 * n, n) = -l.g_v - 0.5 * h * l.g_q;
  if constexpr (HasGauge<Scene>) {
    hessian->template bottomRightCorner<k, k>() =
        -h * system.scene().gauge(Vector<double, n>(0.5 * (q0 + q1)));
  }
  hessian->template topRightCorner<2 * n, k>() =
      hessian->template bottomLeftCorner<k, 2 * n>().transpose();
}

}  // namespace carnot
