// The direct midpoint transcription of a boundary-value problem, interval by interval.
//
// With qm = (q0 + q1)/2, v = (q1 - q0)/h and F_d = h [L - lambda.G v](qm, v), a path that makes
// sum F_d stationary subject to G(qm) v = 0 satisfies exactly the midpoint rule on the index-1
// Hamiltonian system (Marsden & West, Acta Numerica 2001, discrete Legendre transform):
//
//   p0 = -D1 F_d = F_v - h F_q / 2,      p1 = D2 F_d = F_v + h F_q / 2,
//
// so a relaxation of the path needs no guess of p0 and yields a discrete costate.
#pragma once

#include <cmath>

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

// F_d(q0, q1, lambda) with x = (q0, q1, lambda) stacked, of length 2n + k.
template <class Scene, class T>
T discrete_lagrangian(const VelocityConstraints<Scene>& system,
                      double h,
                      const Vector<T, 2 * Scene::kDof + Scene::kMultipliers>& x) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  const Vector<T, n> q0 = x.template head<n>();
  const Vector<T, n> q1 = x.template segment<n>(n);
  const T half = constant<T>(0.5);
  const T rate = constant<T>(1 / h);
  const Vector<T, n> qm = half * (q0 + q1);
  const Vector<T, n> v = rate * (q1 - q0);
  T f = system.lagrangian(qm, v);
  const Vector<T, k> g = system.constraint(qm, v);
  for (int i = 0; i < k; ++i) f -= x[2 * n + i] * g[i];
  return constant<T>(h) * f;
}

}  // namespace carnot
