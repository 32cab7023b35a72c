// The one question an integrator asks: what is dz/dt?
//
// A system is a function H(t, q, p, y) whose algebraic variables y make it stationary, H_y = 0.
// Then q' = H_p and p' = -H_q at frozen y: the terms with dy cancel because H_y = 0 (envelope
// theorem). In the form of McLachlan, Modin, Verdier & Wilkins (2013), eq. (2), this is
// J z' = grad H(z) with z = (q, p, y) and J singular; index 1 means that H_yy is invertible.
#pragma once

#include <concepts>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/system/rate_status.h"

namespace carnot {

// q' and p' at one phase point.
template <class T, int n>
struct Rate {
  Vector<T, n> q_dot;
  Vector<T, n> p_dot;
};

// kOk, or kNotFinite where an entry is infinite or not a number.
template <class T, int n>
[[nodiscard]] RateStatus status_of(const Rate<T, n>& rate) {
  const bool ok = all_finite(rate.q_dot) && all_finite(rate.p_dot);
  return ok ? RateStatus::kOk : RateStatus::kNotFinite;
}

// Associated constants: kDof (n), kAlgebraic (m), kMultipliers (k), and kAutonomous, false where H
// depends on t. All functions are const and thread-safe, allocate nothing and throw nothing.
//
//   rate(t, q, p, y, out)            y: branch and warm start on entry (zero: none), the solution
//                                    of H_y = 0 on exit
//   hamiltonian(t, q, p, y)          H
//   multipliers(t, q, p, y, lambda)  lambda at a solution y
//   constraint(q, v)                 g(q, v), length k
//   speed(q, v)                      the integrand of the length; NaN where there is no metric
//   admissible_momentum(t, q, v, lambda, p)  projects v on the admissible velocities and makes p of
//                                    it; returns how far v was moved, relative to v; NaN on failure
//
// Optional: regularity(t, q, p, y), and branch(t, q, p, lambda, y): the solution y nearest to
// these multipliers.
template <class S>
concept IndexOneSystem = requires(const S& system,
                                  const Vector<double, S::kDof>& q,
                                  Vector<double, S::kDof>& v,
                                  Vector<double, S::kAlgebraic>& y,
                                  Vector<double, S::kMultipliers>& lambda,
                                  Rate<double, S::kDof>& out) {
  { system.rate(0.0, q, q, y, out) } -> std::same_as<RateStatus>;
  { system.hamiltonian(0.0, q, q, y) } -> std::same_as<double>;
  { system.multipliers(0.0, q, q, y, lambda) } -> std::same_as<RateStatus>;
  { system.constraint(q, q) } -> std::convertible_to<Vector<double, S::kMultipliers>>;
  { system.speed(q, q) } -> std::same_as<double>;
  { system.admissible_momentum(0.0, q, v, lambda, v) } -> std::same_as<double>;
  { S::kAutonomous } -> std::convertible_to<bool>;
};

// A system that is reached through function pointers (erased_system.h); its sizes are bounds.
template <class S>
concept IsErased = S::kErased;

// A scene may say `kTimeDependent = true`: H is then not conserved, dH/dt = H_t.
template <class S>
concept IsTimeDependent = S::kTimeDependent;

// A scene may say `kScalarOnly = true`: its formulas branch on values (pack.h).
template <class S>
concept IsScalarOnly = S::kScalarOnly;

template <class S>
concept HasRegularity = requires(const S& system,
                                 const Vector<double, S::kDof>& q,
                                 const Vector<double, S::kAlgebraic>& y) {
  { system.regularity(0.0, q, q, y) } -> std::same_as<Regularity>;
};

template <class S>
concept HasBranches = requires(const S& system,
                               const Vector<double, S::kDof>& q,
                               const Vector<double, S::kMultipliers>& lambda,
                               Vector<double, S::kAlgebraic>& y) {
  { system.branch(0.0, q, q, lambda, y) } -> std::same_as<RateStatus>;
};

}  // namespace carnot
