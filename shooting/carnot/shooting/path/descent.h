// Down from a discrete extremal that is no minimum.
//
// Newton's method (discrete_newton.h) takes saddles of the action for as good as minima, and where
// extremals come in near families, as those to near targets do, relaxed paths lie on the saddles as
// often. But from a saddle there is a way down: with B of discrete_equations.h as the metric, the
// direction of most negative curvature that the constraints allow, by inverse iteration on
//
//   [ H + shift B   A' ]
//   [ A             0  ],
//
// H the Hessian of the action less lambda times the constraints and A the constraints' Jacobian. A
// step to either side, then Newton steps on the constraints' manifold, with as much B added to H as
// makes them descend, back to the constraints after each; the action falls throughout. Nothing has
// units but B, so small paths are as good as large ones.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

// The discrete extremals of less action that the ways down on either side of `saddle`, a discrete
// extremal, lead to: at most two, and none where the saddle is a minimum. Cost: some hundred
// factorisations of the banded matrix.
std::vector<Path> ways_down(const BoundaryValueProblem& problem, const Path& saddle);

}  // namespace carnot::internal
