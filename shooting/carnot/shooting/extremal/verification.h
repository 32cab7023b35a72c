// From joined knots to a verified extremal.
//
// Polishing: the number of steps is doubled until the flow no longer changes. Then p(0) is
// corrected by Newton's method on the end point. Checking: p(0) is integrated once more with twice
// as many steps and must arrive within the tolerance. Where |dq(T)/dp(0)| makes that impossible in
// double, the extremal is checked from knot to knot instead, and says so.
#pragma once

#include <optional>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/extremal/conjugate_times.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/reason.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// Equal actions, such as those of mirror partners, differ by less than this, relative.
inline constexpr double kSameAction = 1e-9;

// The intervals of the path that tells an extremal from others.
inline constexpr int kPathIntervals = 32;

// A verified extremal, its knots, and where it is at equidistant times to tell it from others.
struct Extremal {
  Geodesic geodesic;
  Knots knots;  // none where it is strictly abnormal
  std::vector<std::vector<double>> path;
  bool singular = false;  // dq(T)/dp0 is singular: a member of a family, or abnormal
  std::optional<ConjugateTimes> conjugate;  // where they have been asked for
  int image = 0;                            // of the target, see windings.h
};

// What became of an attempt: the extremal or, where there is none, how far the attempt came.
struct Outcome {
  std::optional<Extremal> extremal;
  Reason reason = Reason::kNone;  // kNone where there is an extremal, or where it was stopped
};

// By how much the check may miss the target: near targets ask for digits relative to the distance.
double allowed_error(const BoundaryValueProblem& problem, double tolerance);

// `steps` is where the search for a step begins.
Outcome verify(const BoundaryValueProblem& problem,
               Knots knots,
               long steps,
               double tolerance,
               const Stop& stop = {});

// Sets endpoint_error and transversality_error or, for kKnots, the knot_defect, by flows of
// `problem` from the knots.
void measure_errors(const BoundaryValueProblem& problem, Extremal& extremal);

// Whether both are the same trajectory: nowhere further apart than 1e-6 of its extent.
bool same(const Extremal& a, const Extremal& b);

// Whether both are singular and of equal action. Then they are members of one continuous family, of
// which one is enough.
bool same_family(const Extremal& a, const Extremal& b);

}  // namespace carnot::internal
