// Conjugate times of an extremal, with multiplicity.
//
// The columns of (X, P) = (dq(t)/dp0, dp(t)/dp0) span a Lagrangian plane that starts at X = 0; t is
// conjugate when X is singular again. The unitary matrix W = (P + iX)(P - iX)^-1 depends on the
// plane only and has the eigenvalue 1 as often as X has a kernel. Its eigenvalues pass through 1 in
// one direction only, upwards, since H_pp >= 0. So with Phi the continuous argument of det W and
// theta_j in [0, 2 pi) the phases of the eigenvalues,
//
//   N(t) = (Phi(t) - sum_j theta_j(t)) / (2 pi)
//
// counts the conjugate times in (0, t), even multiplicities too, where the sign of det X does not.
// The plane is carried from step to step by the tangent flow and made orthonormal again each time,
// so growth of the tangents costs no digits. Source: Arnold, Mathematical Methods of Classical
// Mechanics, appendix 11 (Maslov index).
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/knots.h"

namespace carnot {

struct ConjugateTimes {
  bool known = false;         // false where round-off hides the count, as on abnormal extremals
  std::vector<double> times;  // in (0, T], ascending, repeated by multiplicity
};

// Along the extremal through `knots`; `steps` of the method over the whole time.
ConjugateTimes conjugate_times(const BoundaryValueProblem& problem, const Knots& knots, long steps);

}  // namespace carnot
