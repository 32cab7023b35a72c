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
// with respect to x = (q0, q1, lambda), which has m = 2n + k entries; the Hessian is m x m. The
// chain rule with d qm = (dq0 + dq1)/2 and d v = (dq1 - dq0)/h:
//
//   gradient   (h l_q/2 - l_v,  h l_q/2 + l_v,  -h g)
//   Hessian    in (q0, q0)  h l_qq/4 - (l_vq + l_vq')/2 + l_vv/h
//              in (q1, q1)  h l_qq/4 + (l_vq + l_vq')/2 + l_vv/h
//              in (q0, q1)  h l_qq/4 + (l_vq' - l_vq)/2 - l_vv/h
//              in (lambda, q0) and (lambda, q1)   -h g_q/2 +- G,     in (lambda, lambda)  -h P
//
// Written in loops: Eigen's blocks of this would take a scene a fifth of its time to compile.
template <class Scene>
void discrete_lagrangian(const VelocityConstraints<Scene>& system,
                         double h,
                         const double* x,
                         double* gradient,
                         double* hessian) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  constexpr int m = 2 * n + k;
  Vector<double, n> qm;
  Vector<double, n> v;
  Vector<double, k> lambda;
  for (int i = 0; i < n; ++i) {
    qm[i] = 0.5 * (x[i] + x[n + i]);
    v[i] = (x[n + i] - x[i]) / h;
  }
  for (int i = 0; i < k; ++i) lambda[i] = x[2 * n + i];
  const auto write_gradient = [&](const auto& l) {
    for (int i = 0; i < n; ++i) {
      gradient[i] = 0.5 * h * value_of(l.l_q[i]) - value_of(l.l_v[i]);
      gradient[n + i] = 0.5 * h * value_of(l.l_q[i]) + value_of(l.l_v[i]);
    }
    for (int i = 0; i < k; ++i) gradient[2 * n + i] = -h * value_of(l.g[i]);
  };
  if (hessian == nullptr) {
    write_gradient(lagrangian_slopes(system, qm, v, lambda));
    return;
  }
  const auto l = lagrangian_slopes(system, seeded(qm), v, lambda);
  write_gradient(l);
  // Entry (row, column) and its mirror image.
  const auto set = [&](int row, int column, double value) {
    hessian[column * m + row] = hessian[row * m + column] = value;
  };
  const Matrix<double, n, n> mass = system.scene().mass(qm);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double position = 0.25 * h * l.l_q[i].v[j];
      const double velocity = mass(i, j) / h;
      const double symmetric = 0.5 * (l.l_v[i].v[j] + l.l_v[j].v[i]);
      const double skew = 0.5 * (l.l_v[j].v[i] - l.l_v[i].v[j]);
      hessian[j * m + i] = position - symmetric + velocity;
      hessian[(n + j) * m + n + i] = position + symmetric + velocity;
      set(i, n + j, position + skew - velocity);
    }
  }
  if constexpr (k > 0) {
    const Matrix<double, k, n> rows = system.scene().constraints(qm);
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < n; ++j) {
        const double position = 0.5 * h * l.g[i].v[j];
        set(2 * n + i, j, rows(i, j) - position);
        set(2 * n + i, n + j, -rows(i, j) - position);
      }
      for (int j = 0; j < k; ++j) hessian[(2 * n + i) * m + 2 * n + j] = 0;
    }
  }
  if constexpr (HasGauge<Scene>) {
    const Matrix<double, k, k> gauge = system.scene().gauge(qm);
    for (int i = 0; i < k; ++i) {
      for (int j = 0; j < k; ++j) hessian[(2 * n + j) * m + 2 * n + i] = -h * gauge(i, j);
    }
  }
}

}  // namespace carnot
