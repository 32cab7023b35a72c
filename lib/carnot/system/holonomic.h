// Holonomic constraints h(q) = 0 beside the velocity constraints, and what they ask of the momenta.
//
// With the velocity multipliers eliminated, q' = H_p(q, p), the motion stays on h = 0 only if
//
//   Dh(q) H_p(q, p) = 0,
//
// the hidden constraint. Both together make the manifold of dimension 2(n - l) on which the system
// lives (McLachlan et al. 2013, section 4). Forces of the constraint act along the rows of Dh, so
// momenta are brought to the manifold by p - Dh' nu. That is possible where S = Dh H_pp Dh' is
// invertible: H_pp > 0 but along the rows of G, so rows of Dh and of G must be independent.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "carnot/numerics/lu.h"
#include "carnot/numerics/round_off.h"
#include "carnot/scene/velocity_constrained_scene.h"
#include "carnot/system/phase_space.h"

namespace carnot {

template <class System>
using SceneOf = std::decay_t<decltype(std::declval<const System&>().scene())>;

// A system whose scene has holonomic constraints.
template <class System>
concept HolonomicSystem = IndexOneSystem<System> && HasHolonomic<SceneOf<System>>;

// The number of holonomic constraints, l.
template <class System>
inline constexpr int kHolonomicOf = SceneOf<System>::kHolonomic;

// Dh(q), l x n.
template <class Scene, class T>
Matrix<T, Scene::kHolonomic, Scene::kDof> holonomic_jacobian(const Scene& scene,
                                                             const Vector<T, Scene::kDof>& q) {
  const Vector<Jet<T, Scene::kDof>, Scene::kHolonomic> h = scene.holonomic(seeded(q));
  Matrix<T, Scene::kHolonomic, Scene::kDof> jacobian;
  for (int i = 0; i < Scene::kHolonomic; ++i) {
    for (int j = 0; j < Scene::kDof; ++j) jacobian(i, j) = h[i].v[j];
  }
  return jacobian;
}

// The second derivatives of each h_i(q), n x n.
template <class Scene, class T>
std::array<Matrix<T, Scene::kDof, Scene::kDof>, Scene::kHolonomic> holonomic_hessians(
    const Scene& scene, const Vector<T, Scene::kDof>& q) {
  using J = Jet<Jet<T, Scene::kDof>, Scene::kDof>;
  const Vector<J, Scene::kHolonomic> h = scene.holonomic(seeded(seeded(q)));
  std::array<Matrix<T, Scene::kDof, Scene::kDof>, Scene::kHolonomic> hessians;
  for (int i = 0; i < Scene::kHolonomic; ++i) {
    for (int j = 0; j < Scene::kDof; ++j) {
      for (int k = 0; k < Scene::kDof; ++k) hessians[i](j, k) = h[i].v[j].v[k];
    }
  }
  return hessians;
}

// max |h_i(q)|.
template <class Scene, class T>
T holonomic_residual(const Scene& scene, const Vector<T, Scene::kDof>& q) {
  const Vector<T, Scene::kHolonomic> h = scene.holonomic(q);
  return largest_entry(h);
}

// max |Dh(q) v|.
template <class Scene, class T>
T hidden_residual(const Scene& scene,
                  const Vector<T, Scene::kDof>& q,
                  const Vector<T, Scene::kDof>& v) {
  const Vector<T, Scene::kHolonomic> rate = product(holonomic_jacobian(scene, q), v);
  return largest_entry(rate);
}

// H_pp, which is a part of df/dz.
template <int n, class T>
Matrix<T, n, n> momentum_hessian(const Matrix<T, 2 * n, 2 * n>& jacobian) {
  Matrix<T, n, n> h_pp;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) h_pp(i, j) = jacobian(i, n + j);
  }
  return h_pp;
}

// p <- p - Dh' nu in z = (q, p).
template <class T, int l, int n>
void apply_impulse(const Matrix<T, l, n>& dh, const Vector<T, l>& nu, Vector<T, 2 * n>& z) {
  for (int i = 0; i < l; ++i) {
    for (int j = 0; j < n; ++j) z[n + j] -= dh(i, j) * nu[i];
  }
}

// The inverse of S = Dh H_pp Dh'. False where S is singular to round-off, whatever the scale of
// each h_i. Cost l^3.
template <class T, int l, int n>
[[nodiscard]] bool invert_normal_mass(const Matrix<T, l, n>& dh,
                                      const Matrix<T, n, n>& h_pp,
                                      Matrix<T, l, l>& inverse) {
  const Matrix<T, l, n> weighted = product(dh, h_pp);
  // Symmetric: row by row or column by column is the same.
  Matrix<T, l, l> s = times_transposed(weighted, dh);
  inverse = identity<l, T>();
  if (!lu_solve(l, s.data(), l, inverse.data())) return false;
  // For a positive S, 1 / (S^-1)_ii is the part of row i that the other rows leave.
  const T least = T(64 * n) * epsilon<T>() * largest_entry(h_pp);
  for (int i = 0; i < l; ++i) {
    T square(0);
    for (int j = 0; j < n; ++j) square += dh(i, j) * dh(i, j);
    if (!(inverse(i, i) * least * square < T(1))) return false;
  }
  return all_finite(inverse);
}

// nu with Dh H_p(q, p - Dh' nu) = 0 by Newton's method with one matrix, from the nu on entry:
// exact at once where H_p is linear in p. `z` becomes (q, p - Dh' nu), `z_dot` the rate there, y
// its algebraic variables. `inverse` is that of S somewhere near. kNoSolution where it does not
// contract.
template <class System, class T>
[[nodiscard]] RateStatus solve_hidden_constraint(
    const System& system,
    const T& t,
    const Matrix<T, kHolonomicOf<System>, System::kDof>& dh,
    const Matrix<T, kHolonomicOf<System>, kHolonomicOf<System>>& inverse,
    State<T, System::kDof>& z,
    Vector<T, kHolonomicOf<System>>& nu,
    Vector<T, System::kAlgebraic>& y,
    Vector<T, 2 * System::kDof>& z_dot,
    int& evaluations) {
  constexpr int n = System::kDof;
  constexpr int l = kHolonomicOf<System>;
  constexpr int kMaxIterations = 50;
  const State<T, n> start = z;
  const Matrix<T, n, l> lever = transposed_times(dh, inverse);
  T smallest = std::numeric_limits<T>::max();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    Vector<T, 2 * n> impulse = filled<2 * n>(T(0));
    apply_impulse(dh, nu, impulse);
    z = start;
    z.add(impulse);
    const RateStatus status = phase_rate(system, t, z.value, y, z_dot);
    ++evaluations;
    if (status != RateStatus::kOk) return status;
    const Vector<T, n> v = part<0, n>(z_dot);
    const Vector<T, l> violated = product(dh, v);
    // The change of p, and what the roundings of p and of the sum Dh v make of it.
    const T change = largest_entry(product(lever, violated));
    const Vector<T, l> terms = product(absolute(dh), absolute(v));
    const T rounding = std::max(largest_entry(part<n, n>(z.value)),
                                largest_entry(product(absolute(lever), terms)));
    const T resolution = epsilon<T>() * rounding;
    if (change <= resolution) return RateStatus::kOk;
    if (!(change < smallest)) {
      return change <= T(kStalledRoundOff) * resolution ? RateStatus::kOk : RateStatus::kNoSolution;
    }
    smallest = change;
    const Vector<T, l> step = product(inverse, violated);
    add_to(nu, step);
  }
  return RateStatus::kNoSolution;
}

// Brings p to the hidden constraint at q, by p - Dh' nu. p is unchanged on failure:
// kConstraintRank where the rows of Dh, or of Dh and G, are dependent.
template <HolonomicSystem System, class T>
[[nodiscard]] RateStatus project_momentum(const System& system,
                                          const T& t,
                                          const Vector<T, System::kDof>& q,
                                          Vector<T, System::kDof>& p) {
  constexpr int n = System::kDof;
  constexpr int l = kHolonomicOf<System>;
  State<T, n> z = make_state<T, n>(q, p);
  Vector<T, System::kAlgebraic> y = filled<System::kAlgebraic>(T(0));
  Vector<T, 2 * n> z_dot;
  RateStatus status = phase_rate(system, t, z.value, y, z_dot);
  if (status != RateStatus::kOk) return status;
  Matrix<T, 2 * n, 2 * n> jacobian;
  status = phase_jacobian(system, t, z.value, y, jacobian);
  if (status != RateStatus::kOk) return status;
  const Matrix<T, l, n> dh = holonomic_jacobian(system.scene(), q);
  Matrix<T, l, l> inverse;
  const Matrix<T, n, n> h_pp = momentum_hessian<n>(jacobian);
  if (!invert_normal_mass(dh, h_pp, inverse)) return RateStatus::kConstraintRank;
  Vector<T, l> nu = filled<l>(T(0));
  int evaluations = 0;
  status = solve_hidden_constraint(system, t, dh, inverse, z, nu, y, z_dot, evaluations);
  if (status == RateStatus::kOk) p = part<n, n>(z.value);
  return status;
}

// Brings q to h(q) = 0 along the rows of Dh, to the nearest point for a start close by. False, with
// q unchanged, where Newton's method does not converge.
template <class Scene, class T>
[[nodiscard]] bool project_configuration(const Scene& scene, Vector<T, Scene::kDof>& q) {
  constexpr int n = Scene::kDof;
  constexpr int l = Scene::kHolonomic;
  constexpr int kMaxIterations = 50;
  Vector<T, n> x = q;
  T smallest = std::numeric_limits<T>::max();
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Matrix<T, l, n> dh = holonomic_jacobian(scene, x);
    Matrix<T, l, l> inverse;
    if (!invert_normal_mass(dh, identity<n, T>(), inverse)) return false;
    const Vector<T, l> h = scene.holonomic(x);
    const Vector<T, l> multipliers = product(inverse, h);
    const Vector<T, n> correction = transposed_times(dh, multipliers);
    const T change = largest_entry(correction);
    const T resolution = epsilon<T>() * largest_entry(x);
    if (change <= resolution ||
        (!(change < smallest) && change <= T(kStalledRoundOff) * resolution)) {
      q = x;
      return true;
    }
    smallest = std::min(smallest, change);
    subtract_from(x, correction);
  }
  return false;
}

// d/d(q, p) of Dh H_p, l x 2n. `jacobian` is df/dz at (q, p), v = H_p there.
template <class Scene, class T>
Matrix<T, Scene::kHolonomic, 2 * Scene::kDof> hidden_jacobian(
    const Scene& scene,
    const Vector<T, Scene::kDof>& q,
    const Vector<T, Scene::kDof>& v,
    const Matrix<T, 2 * Scene::kDof, 2 * Scene::kDof>& jacobian) {
  constexpr int n = Scene::kDof;
  const auto hessians = holonomic_hessians(scene, q);
  const auto dh = holonomic_jacobian(scene, q);
  Matrix<T, Scene::kHolonomic, 2 * n> result;
  for (int i = 0; i < Scene::kHolonomic; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      T sum(0);
      for (int k = 0; k < n; ++k) sum += dh(i, k) * jacobian(k, j);
      for (int k = 0; k < n && j < n; ++k) sum += v[k] * hessians[i](k, j);
      result(i, j) = sum;
    }
  }
  return result;
}

}  // namespace carnot
