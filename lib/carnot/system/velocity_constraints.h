// Scenes with linear velocity constraints (Prop. 1 of McLachlan et al. 2013).
//
// The author writes M(q), the rows of G(q) and, if there is one, V(q). With multipliers lambda
//
//   H(q, p, v, lambda) = p.v - v'M v/2 + V + lambda.G v,
//
// stationary in y = (v, lambda):   M v - G' lambda = p   and   G v = 0.
//
// M may be singular: index 1 needs only M > 0 on ker G and G of full rank. Two routes without
// pivots lead to v, and a test holds one against the other.
//
//   multipliers  M is replaced by A = M + gamma G'G, which has the same (v, lambda) since G v = 0
//                and is positive definite for M >= 0. Then S = G A^-1 G', S lambda = -G A^-1 p,
//                v = A^-1 (p + G' lambda). y = (v, lambda).
//   frame        the scene offers B(q) with G B = 0. Then v = B u and
//                H(q, p, u) = p.B u - u'(B'M B) u/2 + V, stationary at (B'M B) u = B'p. y = u.
//                The multipliers, wanted for output only, follow from G G' lambda = G (M v - p).
//
// p' = -H_q at frozen y: with derivatives of M, G, B and V by Jets,
//
//   H_q = -v'M_q v/2 + V_q + lambda.G_q v     or     (p - M v).B_q u - v'M_q v/2 + V_q, v = B u,
//
// where no product of Jets is formed, or by the scene's own `frame_gradient`.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/cholesky.h"
#include "carnot/numerics/gradient.h"
#include "carnot/scene/chart.h"
#include "carnot/scene/velocity_constrained_scene.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/mass_norm.h"

namespace carnot {

template <VelocityConstrainedScene Scene>
class VelocityConstraints {
 public:
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = Scene::kMultipliers;
  static constexpr int kFrame = kDof - kMultipliers;
  static constexpr int kAlgebraic = HasFrame<Scene> ? kFrame : kDof + kMultipliers;
  static constexpr bool kAutonomous = true;
  static constexpr bool kPacks = !IsScalarOnly<Scene>;  // rate() runs on packs

  explicit VelocityConstraints(Scene scene) : scene_(std::move(scene)) {}

  [[nodiscard]] const Scene& scene() const { return scene_; }

  // Solves H_y = 0 and returns q' = v, p' = -H_q. y is output only: the system is linear in it.
  // Cost, with a frame: one factor of size n - k; else one of size n and one of size k.
  template <class T>
  [[nodiscard]] RateStatus rate(const T& /*t*/,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p,
                                Vector<T, kAlgebraic>& y,
                                Rate<T, kDof>& out) const {
    if (!regular_chart(scene_, q)) return RateStatus::kChart;
    if constexpr (HasFrame<Scene>) {
      return frame_rate(q, p, y, out);
    } else {
      return multiplier_rate(q, p, y, out);
    }
  }

  template <class T>
  [[nodiscard]] T hamiltonian(const T& /*t*/,
                              const Vector<T, kDof>& q,
                              const Vector<T, kDof>& p,
                              const Vector<T, kAlgebraic>& y) const {
    if constexpr (HasFrame<Scene>) {
      return frame_hamiltonian(q, p, y);
    } else {
      return multiplier_hamiltonian(q, p, y);
    }
  }

  // L(q, v) = v'M v/2 - V.
  template <class T>
  [[nodiscard]] T lagrangian(const Vector<T, kDof>& q, const Vector<T, kDof>& v) const {
    return kinetic(q, v) - potential(q);
  }

  // V(q), zero for a scene without one.
  template <class T>
  [[nodiscard]] T potential(const Vector<T, kDof>& q) const {
    if constexpr (HasPotential<Scene>) {
      return scene_.potential(q);
    } else {
      return constant<T>(0);
    }
  }

  // g(q, v) = G(q) v.
  template <class T>
  [[nodiscard]] Vector<T, kMultipliers> constraint(const Vector<T, kDof>& q,
                                                   const Vector<T, kDof>& v) const {
    if constexpr (kMultipliers == 0) {
      return {};
    } else {
      return product(scene_.constraints(q), v);
    }
  }

  // sqrt(v'M v), the integrand of the length.
  template <class T>
  [[nodiscard]] T speed(const Vector<T, kDof>& q, const Vector<T, kDof>& v) const {
    using std::sqrt;
    return sqrt(constant<T>(2) * kinetic(q, v));
  }

  // M + gamma G'G: the same velocities and multipliers, positive definite where M >= 0 is not.
  // Any gamma > 0 will do; this one makes both terms of equal size. `g` is G.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> regular_mass(const Vector<T, kDof>& q,
                                                   const Matrix<T, kMultipliers, kDof>& g) const {
    Matrix<T, kDof, kDof> a = scene_.mass(q);
    if constexpr (kMultipliers > 0) {
      const Matrix<T, kDof, kDof> square = transposed_times(g, g);
      T mass_trace = a(0, 0);
      T square_trace = square(0, 0);
      for (int i = 1; i < kDof; ++i) {
        mass_trace += a(i, i);
        square_trace += square(i, i);
      }
      const T gamma = mass_trace / square_trace;
      for (int i = 0; i < kDof; ++i) {
        for (int j = 0; j < kDof; ++j) a(i, j) += gamma * square(i, j);
      }
    }
    return a;
  }

  // lambda from p = M v - G' lambda, by G W G' lambda = G W (M v - p), with W of weighed().
  // Whether the rows of G are independent does not depend on the units of coordinates then.
  template <class T>
  [[nodiscard]] RateStatus multipliers(const Vector<T, kDof>& q,
                                       const Vector<T, kDof>& p,
                                       const Vector<T, kDof>& v,
                                       Vector<T, kMultipliers>& lambda) const {
    if constexpr (kMultipliers > 0) {
      Vector<T, kDof> excess = product(scene_.mass(q), v);
      subtract_from(excess, p);
      const Matrix<T, kMultipliers, kDof> g = scene_.constraints(q);
      const Matrix<T, kMultipliers, kDof> weighted = weighed(counted_masses(q), g);
      const Matrix<T, kMultipliers, kMultipliers> gram = times_transposed(weighted, g);
      const Cholesky<T, kMultipliers> factor(gram);
      if (!factor.positive()) return constraint_failure(gram);
      const Vector<T, kMultipliers> rhs = product(weighted, excess);
      lambda = factor.solve(rhs);
    }
    return RateStatus::kOk;
  }

  // The same from the solution y of rate().
  template <class T>
  [[nodiscard]] RateStatus multipliers(const T& /*t*/,
                                       const Vector<T, kDof>& q,
                                       const Vector<T, kDof>& p,
                                       const Vector<T, kAlgebraic>& y,
                                       Vector<T, kMultipliers>& lambda) const {
    if constexpr (HasFrame<Scene>) {
      return multipliers(q, p, Vector<T, kDof>(product(scene_.frame(q), y)), lambda);
    } else {
      lambda = part<kDof, kMultipliers>(y);
      return RateStatus::kOk;
    }
  }

  // p = M v - G' lambda.
  template <class T>
  [[nodiscard]] Vector<T, kDof> momentum(const Vector<T, kDof>& q,
                                         const Vector<T, kDof>& v,
                                         const Vector<T, kMultipliers>& lambda) const {
    Vector<T, kDof> p = product(scene_.mass(q), v);
    if constexpr (kMultipliers > 0) {
      const Vector<T, kDof> force = transposed_times(scene_.constraints(q), lambda);
      subtract_from(p, force);
    }
    return p;
  }

  // The velocity in ker G nearest to v in the norm of mass_norm.h.
  template <class T>
  [[nodiscard]] RateStatus project(const Vector<T, kDof>& q, Vector<T, kDof>& v) const {
    if constexpr (kMultipliers > 0) {
      const Matrix<T, kMultipliers, kDof> g = scene_.constraints(q);
      const Matrix<T, kMultipliers, kDof> weighted = weighed(counted_masses(q), g);
      const Matrix<T, kMultipliers, kMultipliers> gram = times_transposed(weighted, g);
      const Cholesky<T, kMultipliers> factor(gram);
      if (!factor.positive()) return constraint_failure(gram);
      const Vector<T, kMultipliers> violated = product(g, v);
      const Vector<T, kMultipliers> weights = factor.solve(violated);
      const Vector<T, kDof> move = transposed_times(weighted, weights);
      subtract_from(v, move);
    }
    return RateStatus::kOk;
  }

  // p = M v - G' lambda of the projected velocity; returns how far that is from v, relative to v.
  template <class T>
  [[nodiscard]] T admissible_momentum(const T& /*t*/,
                                      const Vector<T, kDof>& q,
                                      Vector<T, kDof>& v,
                                      const Vector<T, kMultipliers>& lambda,
                                      Vector<T, kDof>& p) const {
    const Vector<T, kDof> given = v;
    if (project(q, v) != RateStatus::kOk) v = filled<kDof>(std::numeric_limits<T>::quiet_NaN());
    p = momentum(q, v, lambda);
    return relative_move(counted_masses(q), given, v);
  }

 private:
  // As mass_norm.h counts coordinates.
  template <class T>
  [[nodiscard]] Vector<T, kDof> counted_masses(const Vector<T, kDof>& q) const {
    const Matrix<T, kDof, kDof> mass = scene_.mass(q);
    Vector<T, kDof> masses;
    for (int j = 0; j < kDof; ++j) masses[j] = counted_mass(mass(j, j));
    return masses;
  }

  template <class T>
  [[nodiscard]] T kinetic(const Vector<T, kDof>& q, const Vector<T, kDof>& v) const {
    const Vector<T, kDof> mv = product(scene_.mass(q), v);
    return constant<T>(0.5) * dot(v, mv);
  }

  template <class T>
  [[nodiscard]] Matrix<T, kFrame, kFrame> frame_mass(const Vector<T, kDof>& q,
                                                     const Matrix<T, kDof, kFrame>& b) const {
    if constexpr (HasFrameMass<Scene>) {
      return scene_.frame_mass(q);
    } else {
      const Matrix<T, kDof, kFrame> mb = product(scene_.mass(q), b);
      return transposed_times(b, mb);
    }
  }

  template <class T>
  [[nodiscard]] T frame_hamiltonian(const Vector<T, kDof>& q,
                                    const Vector<T, kDof>& p,
                                    const Vector<T, kFrame>& u) const {
    const Vector<T, kDof> v = product(scene_.frame(q), u);
    return dot(p, v) - kinetic(q, v) + potential(q);
  }

  template <class T>
  [[nodiscard]] T multiplier_hamiltonian(const Vector<T, kDof>& q,
                                         const Vector<T, kDof>& p,
                                         const Vector<T, kDof + kMultipliers>& y) const {
    const Vector<T, kDof> v = part<0, kDof>(y);
    const Vector<T, kMultipliers> gv = constraint(q, v);
    T h = dot(p, v) - kinetic(q, v) + potential(q);
    for (int i = 0; i < kMultipliers; ++i) h += y[kDof + i] * gv[i];
    return h;
  }

  template <class T>
  [[nodiscard]] RateStatus frame_rate(const Vector<T, kDof>& q,
                                      const Vector<T, kDof>& p,
                                      Vector<T, kFrame>& u,
                                      Rate<T, kDof>& out) const {
    const Matrix<T, kDof, kFrame> b = scene_.frame(q);
    u = transposed_times(b, p);
    if constexpr (HasOrthogonalFrame<Scene>) {
      const Vector<T, kFrame> masses = scene_.frame_masses(q);
      using Number = std::decay_t<decltype(value_of(masses[0]))>;
      bool positive = true;
      for (int i = 0; i < kFrame; ++i) {
        positive = positive && all(value_of(masses[i]) > Number(0));
        u[i] = u[i] / masses[i];
      }
      if (!positive) return mass_failure(masses);
    } else {
      const Matrix<T, kFrame, kFrame> reduced = frame_mass(q, b);
      const Cholesky<T, kFrame> factor(reduced);
      if (!factor.positive()) return mass_failure(reduced);
      u = factor.solve(u);
    }
    out.q_dot = product(b, u);
    if constexpr (HasFrameGradient<Scene>) {
      const Vector<T, kDof> slope = scene_.frame_gradient(q, p, u);
      for (int i = 0; i < kDof; ++i) out.p_dot[i] = -slope[i];
    } else {
      Vector<T, kDof> excess = product(scene_.mass(q), out.q_dot);
      for (int i = 0; i < kDof; ++i) excess[i] = p[i] - excess[i];
      const auto at = seeded(q);
      Vector<T, kDof> slope = kinetic_slope(at, out.q_dot);
      add_slope(scene_.frame(at), excess, u, slope);
      for (int i = 0; i < kDof; ++i) out.p_dot[i] = -slope[i];
    }
    return status_of(out);
  }

  template <class T>
  [[nodiscard]] RateStatus multiplier_rate(const Vector<T, kDof>& q,
                                           const Vector<T, kDof>& p,
                                           Vector<T, kDof + kMultipliers>& y,
                                           Rate<T, kDof>& out) const {
    const Matrix<T, kMultipliers, kDof> g = scene_.constraints(q);
    const Matrix<T, kDof, kDof> a = regular_mass(q, g);
    const Cholesky<T, kDof> factor(a);
    if (!factor.positive()) return diagnose(g, a);
    Vector<T, kDof> v = factor.solve(p);
    if constexpr (kMultipliers > 0) {
      Matrix<T, kDof, kMultipliers> w;  // A^-1 G'
      for (int i = 0; i < kMultipliers; ++i) {
        Vector<T, kDof> row;
        for (int j = 0; j < kDof; ++j) row[j] = g(i, j);
        row = factor.solve(row);
        for (int j = 0; j < kDof; ++j) w(j, i) = row[j];
      }
      const Matrix<T, kMultipliers, kMultipliers> schur = product(g, w);
      const Cholesky<T, kMultipliers> schur_factor(schur);
      if (!schur_factor.positive()) return constraint_failure(g);
      const Vector<T, kMultipliers> rhs = product(g, v);
      Vector<T, kMultipliers> lambda = schur_factor.solve(rhs);
      for (int i = 0; i < kMultipliers; ++i) lambda[i] = -lambda[i];
      const Vector<T, kDof> move = product(w, lambda);
      add_to(v, move);
      for (int i = 0; i < kMultipliers; ++i) y[kDof + i] = lambda[i];
    }
    for (int i = 0; i < kDof; ++i) y[i] = v[i];
    out.q_dot = v;
    const auto at = seeded(q);
    Vector<T, kDof> slope = kinetic_slope(at, v);
    if constexpr (kMultipliers > 0) {
      const Vector<T, kMultipliers> lambda = part<kDof, kMultipliers>(y);
      add_slope(scene_.constraints(at), lambda, v, slope);
    }
    for (int i = 0; i < kDof; ++i) out.p_dot[i] = -slope[i];
    return status_of(out);
  }

  // Adds d/dq of a'm(q) b at fixed a, b to `slope`.
  template <class Jets, class T, int rows, int cols>
  static void add_slope(const Jets& m,
                        const Vector<T, rows>& a,
                        const Vector<T, cols>& b,
                        Vector<T, kDof>& slope) {
    for (int i = 0; i < rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        const T weight = a[i] * b[j];
        for (int d = 0; d < kDof; ++d) slope[d] += weight * m(i, j).v[d];
      }
    }
  }

  // d/dq of V - v'M v/2 at fixed v. `q` is seeded.
  template <class T>
  [[nodiscard]] Vector<T, kDof> kinetic_slope(const Vector<Jet<T, kDof>, kDof>& q,
                                              const Vector<T, kDof>& v) const {
    Vector<T, kDof> slope = filled<kDof>(constant<T>(0));
    if constexpr (HasPotential<Scene>) slope = scene_.potential(q).v;
    const Matrix<Jet<T, kDof>, kDof, kDof> mass = scene_.mass(q);
    for (int i = 0; i < kDof; ++i) {
      for (int j = 0; j <= i; ++j) {
        const T weight = i == j ? constant<T>(-0.5) * v[i] * v[i] : -v[i] * v[j];
        for (int d = 0; d < kDof; ++d) slope[d] += weight * mass(i, j).v[d];
      }
    }
    return slope;
  }

  // Why a factor failed; off the hot path.
  template <class M>
  static RateStatus mass_failure(const M& a) {
    return all_finite(a) ? RateStatus::kMassNotPositive : RateStatus::kNotFinite;
  }
  template <class M>
  static RateStatus constraint_failure(const M& gram) {
    return all_finite(gram) ? RateStatus::kConstraintRank : RateStatus::kNotFinite;
  }
  template <class T>
  static RateStatus diagnose(const Matrix<T, kMultipliers, kDof>& g,
                             const Matrix<T, kDof, kDof>& a) {
    if constexpr (kMultipliers > 0) {
      const Matrix<T, kMultipliers, kMultipliers> gram = times_transposed(g, g);
      if (!Cholesky<T, kMultipliers>(gram).positive()) return constraint_failure(g);
    }
    return mass_failure(a);
  }

  Scene scene_;
};

}  // namespace carnot
