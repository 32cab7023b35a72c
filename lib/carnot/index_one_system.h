// The one question an integrator asks: what is dz/dt?
//
// A system is a function H(t, q, p, y) whose algebraic variables y make it stationary, H_y = 0.
// Then q' = H_p and p' = -H_q at frozen y: the terms with dy cancel because H_y = 0 (envelope
// theorem). In the form of McLachlan, Modin, Verdier & Wilkins (2013), eq. (2), this is
// J z' = grad H(z) with z = (q, p, y) and J singular; index 1 means that H_yy is invertible.
#pragma once

#include <concepts>
#include <string_view>

#include "carnot/linear_algebra.h"

namespace carnot {

enum class RateStatus {
  kOk,
  kConstraintRank,   // the rows of G(q), or of Dh(q), are linearly dependent
  kMassNotPositive,  // M(q) is not positive definite on ker G(q)
  kChart,            // the coordinates are singular
  kNotIndexOne,      // H_yy is singular
  kNoSolution,       // Newton's method for H_y = 0 did not converge
  kNotFinite,        // a value is infinite or not a number
};

// One line for a person: what failed and what it means.
constexpr std::string_view describe(RateStatus status) {
  switch (status) {
    case RateStatus::kOk:
      return "";
    case RateStatus::kConstraintRank:
      return "the constraints are linearly dependent here: rows of G(q), or of Dh(q) where h(q) = "
             "0";
    case RateStatus::kMassNotPositive:
      return "the mass matrix is not positive definite on the admissible velocities (ker G) here";
    case RateStatus::kChart:
      return "the coordinates are singular here: use other coordinates, such as a unit quaternion";
    case RateStatus::kNotIndexOne:
      return "H_yy is singular: the system is not of index 1 here";
    case RateStatus::kNoSolution:
      return "no solution of H_y = 0 was found: start nearer to a branch, or try a smaller step";
    case RateStatus::kNotFinite:
      return "a value is infinite or not a number";
  }
  return "";
}

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

// Why H_y = 0 is hard to solve: of H_yy at one point.
struct Regularity {
  double determinant = 0;
  double condition = 0;
};

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
//                                    it; returns |g(q, v)| / |v| before, NaN on failure
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
