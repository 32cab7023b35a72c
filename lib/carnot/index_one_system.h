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
  kConstraintRank,   // the rows of G(q) are linearly dependent
  kMassNotPositive,  // M(q) is not positive definite on ker G(q)
  kNotFinite,        // a value is infinite or not a number
};

// One line for a person: what failed and what it means.
constexpr std::string_view describe(RateStatus status) {
  switch (status) {
    case RateStatus::kOk:
      return "";
    case RateStatus::kConstraintRank:
      return "the velocity constraints are linearly dependent here: G(q) has lost rank";
    case RateStatus::kMassNotPositive:
      return "the mass matrix is not positive definite on the admissible velocities (ker G) here";
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

// Associated constants: kDof (n), kAlgebraic (m), kMultipliers (k).
// rate(t, q, p, y, out): y is the warm start on entry and the solution of H_y = 0 on exit; const,
// thread-safe, allocates nothing, throws nothing. hamiltonian(t, q, p, y): H itself.
template <class S>
concept IndexOneSystem = requires(const S& system,
                                  const Vector<double, S::kDof>& q,
                                  Vector<double, S::kAlgebraic>& y,
                                  Rate<double, S::kDof>& out) {
  { system.rate(0.0, q, q, y, out) } -> std::same_as<RateStatus>;
  { system.hamiltonian(0.0, q, q, y) } -> std::same_as<double>;
  { S::kMultipliers + 0 } -> std::same_as<int>;
};

}  // namespace carnot
