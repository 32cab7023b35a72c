// The manifold of holonomic constraints: h(q) = 0 and Dh q' = 0.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// Brings q to the nearest point of the manifold, where there is one. False, with q as it was, where
// there is no such point.
bool bring_to_manifold(const Dynamics& dynamics, double* q);

// The same for the momentum p0 at `from`.
bool bring_to_manifold(const BoundaryValueProblem& problem, std::vector<double>& p0);

}  // namespace carnot::internal
