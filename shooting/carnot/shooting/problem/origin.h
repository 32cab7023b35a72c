// A problem moved to the origin of the coordinates that it may be moved along.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// The coordinates along which translations are symmetries. The scene says which they are.
std::vector<int> movable(const SceneInfo& info);

// How far the origin of these coordinates is moved, of length n: to the start or, where that is
// free, to the target.
std::vector<double> origin_of(const BoundaryValueProblem& problem);

// The same problem with these coordinates of the start, or of the target where that is free, at
// zero, where they cost no digits.
BoundaryValueProblem at_origin(const BoundaryValueProblem& problem);

}  // namespace carnot::internal
