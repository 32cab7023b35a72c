// A problem in its natural scales: the same functions of other numbers.
#pragma once

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/problem/natural_scales.h"

namespace carnot::internal {

// The scene in units of the scales, without limits. Flows are those of the scene itself, between
// two changes of units. What is measured relative to it, constraint_error and the values of limits
// and extremes, stays as it is. It has no automatic_flow() and no on_branch(), and no kernel can be
// made of its functions.
Dynamics rescaled(const Dynamics& dynamics, const NaturalScales& scales);
BoundaryValueProblem rescaled(const BoundaryValueProblem& problem, const NaturalScales& scales);

// Back to the units of the scene. Errors at the ends and at knots, which are largest numbers of
// mixed units, become bounds of themselves.
void put_in_own_units(const NaturalScales& scales, Geodesic& geodesic);
// The same of a geodesic of `problem`, whose ends are then those of the problem to the last digit.
void put_in_own_units(const BoundaryValueProblem& problem,
                      const NaturalScales& scales,
                      Geodesic& geodesic);

}  // namespace carnot::internal
