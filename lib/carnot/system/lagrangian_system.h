// Scenes with a Lagrangian L(t, q, v) and velocity constraints g(q, v) = 0, linear in v or not
// (Prop. 2 of McLachlan et al. 2013).
//
// With multipliers lambda and y = (v, lambda)
//
//   H(t, q, p, v, lambda) = p.v - L(t, q, v) + lambda.g(q, v),
//
// stationary in v:       p = dF/dv with F = L - lambda.g, the Legendre transform;
// stationary in lambda:  g(q, v) = 0.
//
// H_yy = (-F_vv, G'; G, 0) with G = dg/dv: of index 1 where G has full rank and F_vv is invertible
// on ker G; F_vv itself may be singular. Where g is not linear in v there can be several (v,
// lambda) for one p, and y keeps the branch that it is on (stationary_newton.h).
#pragma once

#include <array>
#include <limits>
#include <utility>

#include "carnot/numerics/cholesky.h"
#include "carnot/numerics/gradient.h"
#include "carnot/numerics/second_jet.h"
#include "carnot/scene/lagrangian_scene.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/mass_norm.h"
#include "carnot/system/stationary.h"

namespace carnot {

template <LagrangianScene Scene>
class LagrangianSystem {
 public:
  static constexpr int kDof = Scene::kDof;
  static constexpr int kMultipliers = Scene::kMultipliers;
  static constexpr int kAlgebraic = kDof + kMultipliers;
  static constexpr bool kAutonomous = !IsTimeDependent<Scene>;

  explicit LagrangianSystem(Scene scene) : scene_(std::move(scene)) {}

  template <class V>
  using AlgebraicOf = Vector<typename V::Scalar, kAlgebraic>;

  [[nodiscard]] const Scene& scene() const { return scene_; }

  template <class T>
  [[nodiscard]] T lagrangian(const T& t, const Vector<T, kDof>& q, const Vector<T, kDof>& v) const {
    return scene_.lagrangian(t, q, v);
  }

  template <class T>
  [[nodiscard]] Vector<T, kMultipliers> constraint(const Vector<T, kDof>& q,
                                                   const Vector<T, kDof>& v) const {
    if constexpr (kMultipliers == 0) {
      return {};
    } else {
      return scene_.constraint(q, v);
    }
  }

  template <class T>
  [[nodiscard]] T hamiltonian(const T& t,
                              const Vector<T, kDof>& q,
                              const Vector<T, kDof>& p,
                              const Vector<T, kAlgebraic>& y) const {
    const Vector<T, kDof> v = part<0, kDof>(y);
    T h = dot(p, v) - lagrangian(t, q, v);
    const Vector<T, kMultipliers> g = constraint(q, v);
    for (int i = 0; i < kMultipliers; ++i) h += y[kDof + i] * g[i];
    return h;
  }

  // Newton's method on y = (v, lambda); cost and branches: stationary.h.
  template <class T>
  [[nodiscard]] RateStatus rate(const T& t,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p,
                                Vector<T, kAlgebraic>& y,
                                Rate<T, kDof>& out) const {
    return stationary_rate(*this, t, q, p, y, out);
  }

  // (v, 0) with the scene's guess of v; exists where the scene has one.
  template <class T, class S = Scene>
  [[nodiscard]] auto cold_start(const T& t,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p) const
      -> AlgebraicOf<decltype(std::declval<const S&>().velocity_guess(t, q, p))> {
    Vector<T, kAlgebraic> y = filled<kAlgebraic>(T(0));
    const Vector<T, kDof> guess = scene_.velocity_guess(t, q, p);
    for (int i = 0; i < kDof; ++i) y[i] = guess[i];
    return y;
  }

  template <class T>
  [[nodiscard]] RateStatus multipliers(const T& /*t*/,
                                       const Vector<T, kDof>& /*q*/,
                                       const Vector<T, kDof>& /*p*/,
                                       const Vector<T, kAlgebraic>& y,
                                       Vector<T, kMultipliers>& lambda) const {
    lambda = part<kDof, kMultipliers>(y);
    return RateStatus::kOk;
  }

  // A Lagrangian has no metric in general.
  template <class T>
  [[nodiscard]] T speed(const Vector<T, kDof>& /*q*/, const Vector<T, kDof>& /*v*/) const {
    return constant<T>(std::numeric_limits<Real<T>>::quiet_NaN());
  }

  // p = d/dv (L - lambda.g).
  template <class T>
  [[nodiscard]] Vector<T, kDof> momentum(const T& t,
                                         const Vector<T, kDof>& q,
                                         const Vector<T, kDof>& v,
                                         const Vector<T, kMultipliers>& lambda) const {
    using J = Jet<T, kDof>;
    const Vector<J, kDof> qj = unseeded<J>(q);
    return gradient(
        [&](const Vector<J, kDof>& x) {
          J f = lagrangian(J(t), qj, x);
          const Vector<J, kMultipliers> g = constraint(qj, x);
          for (int i = 0; i < kMultipliers; ++i) f -= J(lambda[i]) * g[i];
          return f;
        },
        v);
  }

  // A velocity with g(q, v) = 0 near v, by Gauss-Newton steps that are least in the norm of
  // mass_norm.h at v: for linear g the nearest one. On failure v is unchanged.
  template <class T>
  [[nodiscard]] RateStatus project(const T& t, const Vector<T, kDof>& q, Vector<T, kDof>& v) const {
    if constexpr (kMultipliers > 0) {
      constexpr int kMaxIterations = 50;
      const T resolution = T(4) * epsilon<T>();
      const Vector<T, kDof> masses = counted_masses(t, q, v);
      Vector<T, kDof> x = v;
      T last = std::numeric_limits<T>::max();
      for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
        Vector<T, kMultipliers> g;
        Matrix<T, kMultipliers, kDof> rows;
        linearize_constraint(q, x, g, rows);
        if (!(all_finite(g) && all_finite(rows))) return RateStatus::kNotFinite;
        if (largest_entry(g) == T(0)) {
          v = x;
          return RateStatus::kOk;
        }
        const Matrix<T, kMultipliers, kDof> weighted = weighed(masses, rows);
        const Matrix<T, kMultipliers, kMultipliers> gram = times_transposed(weighted, rows);
        const Cholesky<T, kMultipliers> factor(gram);
        if (!factor.positive()) return RateStatus::kConstraintRank;
        const Vector<T, kDof> step = transposed_times(weighted, factor.solve(g));
        const T size = mass_norm(masses, step);
        subtract_from(x, step);
        // At round-off, or as near to it as the rounding of g allows.
        const T few = resolution * mass_norm(masses, x);
        if (size <= few || (size <= T(16) * few && size >= last)) {
          v = x;
          return RateStatus::kOk;
        }
        last = size;
      }
      return RateStatus::kNoSolution;
    }
    return RateStatus::kOk;
  }

  // p of the projected velocity; returns how far that is from v, relative to v.
  template <class T>
  [[nodiscard]] T admissible_momentum(const T& t,
                                      const Vector<T, kDof>& q,
                                      Vector<T, kDof>& v,
                                      const Vector<T, kMultipliers>& lambda,
                                      Vector<T, kDof>& p) const {
    const Vector<T, kDof> given = v;
    if (project(t, q, v) != RateStatus::kOk) v = filled<kDof>(std::numeric_limits<T>::quiet_NaN());
    p = momentum(t, q, v, lambda);
    return relative_move(counted_masses(t, q, given), given, v);
  }

  [[nodiscard]] Regularity regularity(double t,
                                      const Vector<double, kDof>& q,
                                      const Vector<double, kDof>& p,
                                      const Vector<double, kAlgebraic>& y) const {
    return stationary_regularity(*this, t, q, p, y);
  }

  // The solution whose multipliers are nearest to `lambda`, of those found from several starts: the
  // cold one, and v from the Legendre transform at fixed multipliers around `lambda` and around the
  // cold solution, each followed by Newton's method on both. On failure y is unchanged.
  // Cost: some fifty solutions; for the beginning of a flow.
  [[nodiscard]] RateStatus branch(double t,
                                  const Vector<double, kDof>& q,
                                  const Vector<double, kDof>& p,
                                  const Vector<double, kMultipliers>& lambda,
                                  Vector<double, kAlgebraic>& y) const {
    const StationaryEquations<LagrangianSystem, double> equations{*this, t, q, p};
    Vector<double, kAlgebraic> found;
    RateStatus result = stationary_cold_start(equations, found);
    if (result == RateStatus::kOk) y = found;
    if constexpr (kMultipliers > 0) {
      const auto distance = [&lambda](const Vector<double, kAlgebraic>& x) {
        Vector<double, kMultipliers> away = part<kDof, kMultipliers>(x);
        subtract_from(away, lambda);
        return largest_entry(away);
      };
      constexpr double kInfinity = std::numeric_limits<double>::infinity();
      double nearest = result == RateStatus::kOk ? distance(y) : kInfinity;
      const auto search = [&](const Vector<double, kMultipliers>& centre) {
        constexpr std::array kOffsets{0.0, 0.01, -0.01, 0.1, -0.1, 0.3, -0.3, 1.0, -1.0, 3.0, -3.0};
        const double size = 1 + largest_entry(centre);
        for (int moved = 0; moved < kMultipliers; ++moved) {
          for (const double offset : kOffsets) {
            Vector<double, kMultipliers> start = centre;
            start[moved] += offset * size;
            const RateStatus status = solve_near(equations, start, found);
            if (status == RateStatus::kOk && distance(found) < nearest) {
              nearest = distance(found);
              y = found;
            }
            if (result != RateStatus::kOk) result = status;
          }
        }
      };
      const Vector<double, kMultipliers> cold = part<kDof, kMultipliers>(found);
      const bool cold_found = result == RateStatus::kOk;
      search(lambda);
      if (cold_found) search(cold);
    }
    return result;
  }

 private:
  // As mass_norm.h counts coordinates.
  template <class T>
  [[nodiscard]] Vector<T, kDof> counted_masses(const T& t,
                                               const Vector<T, kDof>& q,
                                               const Vector<T, kDof>& v) const {
    using J = SecondJet<T, 1>;
    const Vector<J, kDof> qj = unseeded<J>(q);
    Vector<J, kDof> vj = unseeded<J>(v);
    Vector<T, kDof> masses;
    for (int j = 0; j < kDof; ++j) {
      vj[j] = J(v[j], 0);
      masses[j] = counted_mass(lagrangian(J(t), qj, vj).w[0]);
      vj[j] = J(v[j]);
    }
    return masses;
  }

  // H as a function of v alone.
  struct FixedMultipliers {
    static constexpr int kDof = Scene::kDof;
    static constexpr int kAlgebraic = Scene::kDof;

    const LagrangianSystem& system;
    Vector<double, kMultipliers> lambda;

    template <class T>
    [[nodiscard]] T hamiltonian(const T& t,
                                const Vector<T, kDof>& q,
                                const Vector<T, kDof>& p,
                                const Vector<T, kDof>& v) const {
      Vector<T, kDof + kMultipliers> y;
      for (int i = 0; i < kDof; ++i) y[i] = v[i];
      for (int i = 0; i < kMultipliers; ++i) y[kDof + i] = constant<T>(lambda[i]);
      return system.hamiltonian(t, q, p, y);
    }
  };

  // v at fixed multipliers, then v and multipliers.
  [[nodiscard]] RateStatus solve_near(
      const StationaryEquations<LagrangianSystem, double>& equations,
      const Vector<double, kMultipliers>& lambda,
      Vector<double, kAlgebraic>& y) const {
    const FixedMultipliers fixed{*this, lambda};
    const StationaryEquations<FixedMultipliers, double> legendre{
        fixed, equations.t, equations.q, equations.p};
    Vector<double, kDof> v;
    const RateStatus status = stationary_cold_start(legendre, v);
    if (status != RateStatus::kOk) return status;
    for (int i = 0; i < kDof; ++i) y[i] = v[i];
    for (int i = 0; i < kMultipliers; ++i) y[kDof + i] = lambda[i];
    return StationaryNewton(equations).solve(Pursuit::kAny, y);
  }

  // g and G = dg/dv.
  template <class T>
  void linearize_constraint(const Vector<T, kDof>& q,
                            const Vector<T, kDof>& v,
                            Vector<T, kMultipliers>& g,
                            Matrix<T, kMultipliers, kDof>& rows) const {
    using J = Jet<T, kDof>;
    const Vector<J, kMultipliers> gj = constraint(unseeded<J>(q), seeded(v));
    for (int i = 0; i < kMultipliers; ++i) {
      g[i] = gj[i].a;
      for (int j = 0; j < kDof; ++j) rows(i, j) = gj[i].v[j];
    }
  }

  Scene scene_;
};

}  // namespace carnot
