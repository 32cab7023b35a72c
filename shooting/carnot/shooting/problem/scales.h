// Sizes of a problem: what its straight line tells of them.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// What the straight line tells of sizes.
struct StartScales {
  double distance = 0;            // D
  double radian = 1;              // S
  double violation = 0;           // root mean square of |G(q) (to - from)|
  std::vector<double> per_metre;  // change of coordinate j that has length 1
};

StartScales start_scales(const BoundaryValueProblem& problem);

// Whether every coordinate is an angle.
bool has_only_angles(const Dynamics& dynamics);

}  // namespace carnot::internal
