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

#include "carnot/numerics/cholesky.h"
#include "carnot/numerics/gradient.h"
#include "carnot/system/velocity_constraints.h"

namespace carnot {

// What the least-squares form of one interval needs at qm: U with v'U'U v = v'M v + gamma |G v|^2,
// gamma as in the multiplier route (so that singular M is allowed too), G, and V. The interval has
// r = U v, c = G v.
template <class T, int n, int k>
struct MidpointFactors {
  Matrix<T, n, n> root;  // upper triangular; nothing is said below the diagonal
  Matrix<T, k, n> constraints;
  T potential;
};

template <class Scene, class T>
[[nodiscard]] bool midpoint_factors(const VelocityConstraints<Scene>& system,
                                    const Vector<T, Scene::kDof>& qm,
                                    MidpointFactors<T, Scene::kDof, Scene::kMultipliers>& out) {
  using std::sqrt;
  constexpr int n = Scene::kDof;
  if constexpr (Scene::kMultipliers > 0) out.constraints = system.scene().constraints(qm);
  const Matrix<T, n, n> mass = system.regular_mass(qm, out.constraints);
  Matrix<T, n, n> lower;
  Vector<T, n> pivots;
  if (!cholesky_factor(mass, lower, pivots)) return false;
  for (int i = 0; i < n; ++i) {  // U = D^(1/2) L'
    out.root(i, i) = sqrt(pivots[i]);
    for (int j = i + 1; j < n; ++j) out.root(i, j) = out.root(i, i) * lower(j, i);
  }
  out.potential = system.potential(qm);
  return true;
}

// First derivatives of l(q, v) = L - lambda.G v - lambda'P lambda/2 at fixed lambda.
template <class T, int n, int k>
struct LagrangianSlopes {
  Vector<T, n> l_q;
  Vector<T, n> l_v;  // M v - G' lambda, the momentum
  Vector<T, k> g;    // G v + P lambda
};

// A scene with dependent rows writes both itself: gauge(q) -> P, and its slopes(q, v, lambda).
template <class S>
concept HasGauge = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.gauge(q) } -> std::convertible_to<Matrix<double, S::kMultipliers, S::kMultipliers>>;
};

// T is double, or a Jet for second derivatives. l is quadratic in v, so that Jets are needed in the
// n directions of q only, and linear in M, G and V, so that no product of Jets is formed.
template <class Scene, class T>
LagrangianSlopes<T, Scene::kDof, Scene::kMultipliers> lagrangian_slopes(
    const VelocityConstraints<Scene>& system,
    const Vector<T, Scene::kDof>& q,
    const Vector<double, Scene::kDof>& v,
    const Vector<double, Scene::kMultipliers>& lambda) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  if constexpr (HasGauge<Scene>) {
    return system.scene().slopes(q, v, lambda);
  } else {
    LagrangianSlopes<T, n, k> out;
    out.l_q.setConstant(constant<T>(0));
    out.l_v.setConstant(constant<T>(0));
    out.g.setConstant(constant<T>(0));
    const auto x = seeded(q);
    const auto add = [&](const Jet<T, n>& entry, double weight) {
      for (int d = 0; d < n; ++d) out.l_q[d] += entry.v[d] * weight;
    };
    if constexpr (HasPotential<Scene>) add(system.potential(x), -1);
    const Matrix<Jet<T, n>, n, n> mass = system.scene().mass(x);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        out.l_v[i] += mass(i, j).a * v[j];
        if (j <= i) add(mass(i, j), (j < i ? 1 : 0.5) * v[i] * v[j]);
      }
    }
    if constexpr (k > 0) {
      const Matrix<Jet<T, n>, k, n> rows = system.scene().constraints(x);
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j < n; ++j) {
          out.g[i] += rows(i, j).a * v[j];
          out.l_v[j] += rows(i, j).a * -lambda[i];
          add(rows(i, j), -lambda[i] * v[j]);
        }
      }
    }
    return out;
  }
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
  const Vector<double, n> qm = 0.5 * (q0 + q1);
  const Vector<double, n> v = (q1 - q0) / h;
  const Vector<double, k> lambda = x.template tail<k>();
  const auto write_gradient = [&](const auto& l_q, const auto& l_v, const auto& g) {
    gradient_out << 0.5 * h * l_q - l_v, 0.5 * h * l_q + l_v, -h * g;
  };
  if (hessian == nullptr) {
    const auto l = lagrangian_slopes(system, qm, v, lambda);
    write_gradient(l.l_q, l.l_v, l.g);
    return;
  }
  const auto l = lagrangian_slopes(system, seeded(qm), v, lambda);
  write_gradient(primal(l.l_q), primal(l.l_v), primal(l.g));
  const Matrix<double, n, n> l_vq = tangents(l.l_v);
  const Matrix<double, k, n> g_q = tangents(l.g);
  const Matrix<double, k, n> g_v = system.scene().constraints(qm);  // G
  const Matrix<double, n, n> symmetric = 0.5 * (l_vq + l_vq.transpose());
  const Matrix<double, n, n> skew = 0.5 * (l_vq.transpose() - l_vq);
  const Matrix<double, n, n> position = 0.25 * h * tangents(l.l_q);
  const Matrix<double, n, n> velocity = system.scene().mass(qm) / h;
  hessian->setZero();
  hessian->template block<n, n>(0, 0) = position - symmetric + velocity;
  hessian->template block<n, n>(n, n) = position + symmetric + velocity;
  hessian->template block<n, n>(0, n) = position + skew - velocity;
  hessian->template block<n, n>(n, 0) = hessian->template block<n, n>(0, n).transpose();
  hessian->template block<k, n>(2 * n, 0) = g_v - 0.5 * h * g_q;
  hessian->template block<k, n>(2 * n, n) = -g_v - 0.5 * h * g_q;
  if constexpr (HasGauge<Scene>) {
    hessian->template bottomRightCorner<k, k>() = -h * system.scene().gauge(qm);
  }
  hessian->template topRightCorner<2 * n, k>() =
      hessian->template bottomLeftCorner<k, 2 * n>().transpose();
}

}  // namespace carnot
