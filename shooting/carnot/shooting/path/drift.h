// The motion without controls, on the grid.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

// The nodes of the midpoint rule for q' = d H_p(t, q, 0), `steps` steps of length h from q at time
// t; backwards where h is negative. It ends early where the rule has no solution near.
std::vector<std::vector<double>> drift_nodes(const Dynamics& dynamics,
                                             double d,
                                             const std::vector<double>& q,
                                             double t,
                                             double h,
                                             int steps);

}  // namespace carnot::internal
