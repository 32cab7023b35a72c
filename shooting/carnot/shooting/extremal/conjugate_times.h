// Conjugate times of an extremal, with multiplicity.
//
// The columns of (X, P) = (dq(t)/dp0, dp(t)/dp0) span a Lagrangian plane that starts at X = 0; t is
// conjugate when the rank of X drops below its generic one. The phases theta_j of the plane
// (lagrangian_plane.h) pass through 0 in one direction only, upwards, since H_pp >= 0. So with Phi
// the continuous argument of det W = exp(i sum_j theta_j) and the theta_j in [0, 2 pi),
//
//   N(t) = (Phi(t) - sum_j theta_j(t)) / (2 pi)
//
// counts the conjugate times in (0, t), even multiplicities too, where the sign of det X does not.
// On an abnormal extremal as many phases as its corank stay at 0; these are left out. The tangent
// flow carries the plane from step to step, and its basis is made orthonormal again each time, so
// that growth of the tangents costs no digits. Where X and P do not stay of one size, as along an
// unstable drift, the count is made with scales that change along the path: N does not depend on
// them. Source: Arnold, Mathematical Methods of Classical
// Mechanics, appendix 11 (Maslov index).
//
// Where coordinates of the start are free, (X, P) are the derivatives by the unknowns x of ends.h.
// The plane starts with dq_j in the place of dp_j, and the times are focal times. Where coordinates
// E of the target are free, its movements count, too. The action of the extremals nearby has the
// second derivatives P X^-1 by the target. So on combinations a of the columns that leave the fixed
// coordinates alone, the index grows by that of the form (X a)_E.(P a)_E. It grows by one for each
// dimension of E that no such combination reaches, too: T is conjugate with a momentum along it.
// The extremal is degenerate where some a leaves the fixed coordinates and the free momenta alone
// (Agrachev & Sachkov, Control Theory from the Geometric Viewpoint, 2004, ch. 21).
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// What moving the free coordinates of the target adds.
struct TargetForm {
  int index = 0;
  int nullity = 0;
};

struct ConjugateTimes {
  bool known = false;                // false where round-off hides the count
  std::vector<double> times;         // in (0, T], ascending, repeated by multiplicity
  int at_end = 0;                    // how many of them are T
  std::optional<int> corank;         // n - the generic rank of X; > 0: abnormal
  std::optional<TargetForm> target;  // where coordinates of the target are free
  bool legendre = true;              // false where they mean nothing, see legendre.h
};

struct ConjugateTimesOptions {
  // A phase that is nearer to zero at T counts as zero. Then T is conjugate, as far as it can be
  // told with an extremal that is known only so well.
  double doubt = 1e-8;
  double precision = 1e-13;  // relative, of the times; with 1 they are counted, not located
  std::size_t most = std::numeric_limits<std::size_t>::max();  // only so many, the first ones
};

// Along the extremal through `knots`; `steps` of the method over the whole time. To locate a time
// costs some forty of them.
ConjugateTimes conjugate_times(const BoundaryValueProblem& problem,
                               const Knots& knots,
                               long steps,
                               const ConjugateTimesOptions& options = {});

}  // namespace carnot::internal
