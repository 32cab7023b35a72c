// Down from a discrete extremal that is no minimum.
//
// Newton's method (discrete_newton.h) takes saddles of the action for as good as minima. Extremals
// to near targets come in near families, and there a relaxed path lies on a saddle as often as on a
// minimum. But from a saddle there is a way down. Let B of discrete_equations.h be the metric. The
// direction of most negative curvature that the constraints allow is found by inverse iteration on
//
//   [ H + shift B   A' ]
//   [ A             0  ],
//
// where H is the Hessian of the action less lambda times the constraints, and A is the Jacobian of
// the constraints. A step to either side of the saddle leads off it. Newton steps follow on the
// manifold of the constraints, with as much B added to H as makes them descend; after each step the
// path is brought back to the constraints. The action falls throughout. Nothing has units but B, so
// small paths are as good as large ones.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

// `saddle` is a discrete extremal. Returns those of less action to which the ways down on its two
// sides lead: at most two, and none where `saddle` is a minimum. Cost: some hundred factorisations
// of the banded matrix.
std::vector<Path> ways_down(const BoundaryValueProblem& problem, const Path& saddle);

}  // namespace carnot::internal
