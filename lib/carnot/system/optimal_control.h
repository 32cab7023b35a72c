// Optimal-control scenes: minimise the integral of l(t, q, u) subject to q' = f(t, q, u).
//
// Pontryagin's H(t, q, p, u) = p.f - l, stationary in y = u:
//
//   f_u' p = l_u,      q' = f,      p' = -H_q at frozen u.
//
// Index 1 means that H_uu = p.f_uu - l_uu is regular; where it is negative definite the extremal is
// a local maximum of H in u, as an optimal one must be (Legendre's condition).
//
//   linear   f = f0 + F u, l = l0 + u'R u/2:  R u = F'p, by one factor of size c without pivots.
//   general  Newton's method of stationary.h.
//
// Every scene can be written for the general route; a test holds one route against the other.
// Sources: McLachlan et al. (2013), introduction; Agrachev & Sachkov, Control Theory from the
// Geometric Viewpoint (2004), ch. 12.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/numerics/cholesky.h"
#include "carnot/numerics/gradient.h"
#include "carnot/numerics/pseudo_inverse.h"
#include "carnot/scene/chart.h"
#include "carnot/scene/optimal_control_scene.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/stationary.h"

namespace carnot {

template <OptimalControlScene Scene>
class OptimalControl {
 public:
  static constexpr int kDof = Scene::kDof;
  static constexpr int kControls = Scene::kControls;
  static constexpr int kAlgebraic = kControls;
  static constexpr int kMultipliers = 0;
  static constexpr bool kAutonomous = !IsTimeDependent<Scene>;
  // rate() runs on packs: no iteration.
  static constexpr bool kPacks = HasLinearControls<Scene> && !IsScalarOnly<Scene>;
  // f = F u and l = u'R u/2: lengths are those of a sub-Riemannian metric.
  static constexpr bool kMetric =
      HasLinearControls<Scene> && !HasDrift<Scene> && !HasStateCost<Scene>;

  explicit OptimalControl(Scene scene) : scene_(std::move(scene)) {}

  [[nodiscard]] const Scene& scene() const { return scene_; }

  // f(t, q, u).
  template <class T>
  [[nodiscard]] Vector<T, kDof> dynamics(const T& t,
                                         const Vector<T, kDof>& q,
                                         const Vector<T, kControls>& u) const {
    if constexpr (HasLinearControls<Scene>) {
      Vector<T, kDof> f = product(scene_.frame(q), u);
      if constexpr (HasDrift<Scene>) f += scene_.drift(q);
      return f;
    } else {
      return scene_.dynamics(t, q, u);
    }
  }

  // l(t, q, u), the integrand of the action.
  template <class T>
  [[nodiscard]] T running_cost(const T& t,
                               const Vector<T, kDof>& q,
                               const Vector<T, kControls>& u) const {
    if constexpr (HasLinearControls<Scene>) {
      T cost = constant<T>(0.5) * dot(u, weighted(q, u));
      if constexpr (HasStateCost<Scene>) cost += scene_.state_cost(q);
      return cost;
    } else {
      return scene_.running_cost(t, q, u);
    }
  }

  // Solves H_u = 0 for u and returns q' = f, p' = -H_q. Linear: u is output only.
  template <class T>
  [[nodiscard]] RateStatus rate(const T& t,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p,
                                Vector<T, kControls>& u,
                                Rate<T, kDof>& out) const {
    if (!regular_chart(scene_, q)) return RateStatus::kChart;
    if constexpr (HasLinearControls<Scene>) {
      return linear_rate(t, q, p, u, out);
    } else {
      return stationary_rate(*this, t, q, p, u, out);
    }
  }

  template <class T>
  [[nodiscard]] T hamiltonian(const T& t,
                              const Vector<T, kDof>& q,
                              const Vector<T, kDof>& p,
                              const Vector<T, kControls>& u) const {
    return dot(p, dynamics(t, q, u)) - running_cost(t, q, u);
  }

  // The branch of a cold start, where the scene says so.
  template <class T, HasInitialControls S = Scene>
  [[nodiscard]] Vector<T, kControls> cold_start(const T& t,
                                                const Vector<T, kDof>& q,
                                                const Vector<T, kDof>& p) const {
    return scene_.initial_controls(t, q, p);
  }

  // There are none.
  template <class T>
  [[nodiscard]] RateStatus multipliers(const T& /*t*/,
                                       const Vector<T, kDof>& /*q*/,
                                       const Vector<T, kDof>& /*p*/,
                                       const Vector<T, kControls>& /*u*/,
                                       Vector<T, 0>& /*lambda*/) const {
    return RateStatus::kOk;
  }
  template <class T>
  [[nodiscard]] Vector<T, 0> constraint(const Vector<T, kDof>& /*q*/,
                                        const Vector<T, kDof>& /*v*/) const {
    return {};
  }

  // sqrt(2 l) with the cheapest u that gives v = F u; NaN for a cost that is no metric.
  template <class T>
  [[nodiscard]] T speed(const Vector<T, kDof>& q, const Vector<T, kDof>& v) const {
    if constexpr (kMetric) {
      return PseudoInverse<T, kDof, kControls>(orthonormal_frame(q)).solve(v).norm();
    } else {
      return constant<T>(std::numeric_limits<Real<T>>::quiet_NaN());
    }
  }

  // Finds u with f(t, q, u) = v, sets v = f and p to the least-norm solution of f_u' p = l_u.
  // Returns |v - f| over the larger of |v| and the velocity without control; NaN where there is no
  // such p. Linear: the f nearest to v, and u the cheapest. General: Gauss-Newton from the cold
  // start for p = v.
  template <class T>
  [[nodiscard]] T admissible_momentum(const T& t,
                                      const Vector<T, kDof>& q,
                                      Vector<T, kDof>& v,
                                      const Vector<T, 0>& /*lambda*/,
                                      Vector<T, kDof>& p) const {
    const Vector<T, kDof> wanted = v;
    const Vector<T, kControls> none = filled<kControls>(T(0));
    bool found = regular_chart(scene_, q);
    if constexpr (HasLinearControls<Scene>) {
      const Matrix<T, kDof, kControls> frame = orthonormal_frame(q);
      const PseudoInverse<T, kDof, kControls> inverse(frame);
      const Vector<T, kDof> drift = dynamics(t, q, none);
      Vector<T, kDof> controlled = wanted;
      subtract_from(controlled, drift);
      const Vector<T, kControls> w = inverse.solve(controlled);
      v = product(frame, w);
      add_to(v, drift);
      p = inverse.solve_transposed(w);
    } else {
      found = found && general_momentum(t, q, v, p);
    }
    if (!found) v = filled<kDof>(std::numeric_limits<T>::quiet_NaN());
    const T violated = (wanted - v).norm();
    const T scale = std::max(wanted.norm(), dynamics(t, q, none).norm());
    return violated == T(0) ? violated : T(violated / scale);
  }

  // Of H_uu.
  [[nodiscard]] Regularity regularity(double t,
                                      const Vector<double, kDof>& q,
                                      const Vector<double, kDof>& p,
                                      const Vector<double, kControls>& u) const {
    return stationary_regularity(*this, t, q, p, u);
  }

 private:
  // R u.
  template <class T>
  [[nodiscard]] Vector<T, kControls> weighted(const Vector<T, kDof>& q,
                                              const Vector<T, kControls>& u) const {
    if constexpr (HasControlWeight<Scene>) {
      return product(scene_.control_weight(q), u);
    } else {
      return u;
    }
  }

  template <class T>
  [[nodiscard]] RateStatus linear_rate(const T& t,
                                       const Vector<T, kDof>& q,
                                       const Vector<T, kDof>& p,
                                       Vector<T, kControls>& u,
                                       Rate<T, kDof>& out) const {
    const Matrix<T, kDof, kControls> frame = scene_.frame(q);
    u = transposed_times(frame, p);
    if constexpr (HasControlWeight<Scene>) {
      const Matrix<T, kControls, kControls> weight = scene_.control_weight(q);
      const Cholesky<T, kControls> factor(weight);
      if (!factor.positive()) {
        return all_finite(weight) ? RateStatus::kNotIndexOne : RateStatus::kNotFinite;
      }
      u = factor.solve(u);
    }
    out.q_dot = product(frame, u);
    if constexpr (HasDrift<Scene>) out.q_dot += scene_.drift(q);
    if constexpr (HasControlGradient<Scene>) {
      const Vector<T, kDof> slope = scene_.frame_gradient(q, p, u);
      for (int i = 0; i < kDof; ++i) out.p_dot[i] = -slope[i];
    } else {
      using J = Jet<T, kDof>;
      const Vector<J, kDof> pj = unseeded<J>(p);
      const Vector<J, kControls> uj = unseeded<J>(u);
      const Vector<T, kDof> slope =
          gradient([&](const auto& x) { return hamiltonian(J(t), x, pj, uj); }, q);
      for (int i = 0; i < kDof; ++i) out.p_dot[i] = -slope[i];
    }
    return status_of(out);
  }

  // F R^(-1/2), the velocities of controls of cost 1/2 each: with R = L D L', u = L'^-1 D^(-1/2) w
  // costs |w|^2/2. NaN where R is not positive definite.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kControls> orthonormal_frame(const Vector<T, kDof>& q) const {
    Matrix<T, kDof, kControls> b = scene_.frame(q);
    if constexpr (HasControlWeight<Scene>) {
      using std::sqrt;
      Matrix<T, kControls, kControls> lower;
      Vector<T, kControls> pivots;
      const bool positive =
          cholesky_factor(Matrix<T, kControls, kControls>(scene_.control_weight(q)), lower, pivots);
      if (!positive) pivots = filled<kControls>(std::numeric_limits<T>::quiet_NaN());
      for (int i = 0; i < kDof; ++i) {
        for (int j = 0; j < kControls; ++j) {
          for (int k = 0; k < j; ++k) b(i, j) -= lower(j, k) * b(i, k);
        }
        for (int j = 0; j < kControls; ++j) b(i, j) /= sqrt(pivots[j]);
      }
    }
    return b;
  }

  // f_u at u.
  template <class T>
  [[nodiscard]] Matrix<T, kDof, kControls> control_jacobian(const T& t,
                                                            const Vector<T, kDof>& q,
                                                            const Vector<T, kControls>& u) const {
    using J = Jet<T, kControls>;
    const Vector<J, kDof> f = dynamics(J(t), unseeded<J>(q), seeded(u));
    Matrix<T, kDof, kControls> jacobian;
    for (int i = 0; i < kDof; ++i) {
      for (int j = 0; j < kControls; ++j) jacobian(i, j) = f[i].v[j];
    }
    return jacobian;
  }

  // The general half of admissible_momentum(). False where f_u' p = l_u has no solution.
  template <class T>
  [[nodiscard]] bool general_momentum(const T& t,
                                      const Vector<T, kDof>& q,
                                      Vector<T, kDof>& v,
                                      Vector<T, kDof>& p) const {
    using std::sqrt;
    constexpr int kMaxIterations = 50;
    constexpr int kMaxHalvings = 30;
    const Vector<T, kDof> wanted = v;
    Vector<T, kControls> u = filled<kControls>(T(0));
    if constexpr (HasInitialControls<Scene>) u = cold_start(t, q, v);
    v = dynamics(t, q, u);
    bool falling = true;
    for (int iteration = 0; iteration < kMaxIterations && falling; ++iteration) {
      const PseudoInverse<T, kDof, kControls> inverse(control_jacobian(t, q, u));
      const Vector<T, kControls> step = inverse.solve(Vector<T, kDof>(wanted - v));
      T length(1);
      falling = false;
      for (int halving = 0; halving < kMaxHalvings && !falling; ++halving, length *= T(0.5)) {
        const Vector<T, kControls> trial = u + length * step;
        const Vector<T, kDof> reached = dynamics(t, q, trial);
        falling = (wanted - reached).norm() < (wanted - v).norm();
        if (!falling) continue;
        u = trial;
        v = reached;
      }
    }
    using J = Jet<T, kControls>;
    const Vector<T, kControls> slope = gradient(
        [&](const auto& x) { return running_cost(J(t), Vector<J, kDof>(unseeded<J>(q)), x); }, u);
    const Matrix<T, kDof, kControls> jacobian = control_jacobian(t, q, u);
    p = PseudoInverse<T, kDof, kControls>(jacobian).solve_transposed(slope);
    Vector<T, kControls> rest = transposed_times(jacobian, p);
    subtract_from(rest, slope);
    return rest.norm() <= sqrt(epsilon<T>()) * slope.norm();
  }

  Scene scene_;
};

}  // namespace carnot
