// A problem moved to the origin of the coordinates that it may be moved along.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// The coordinates along which translations are symmetries. The scene says which they are.
std::vector<int> movable(const SceneInfo& info);

// The same problem with these coordinates of `from` at zero, where they cost no digits.
BoundaryValueProblem at_origin(const BoundaryValueProblem& problem);

}  // namespace carnot::internal
