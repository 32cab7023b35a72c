// A family of boundary-value problems, from one at s = 0 to one at s = 1.
#pragma once

#include <functional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot {

struct ProblemLine {
  // The problem at s, for s in [0, 1]; analytic in s, the same dimensions everywhere.
  std::function<BoundaryValueProblem(double s)> at;
  // Only `to` depends on s, and linearly: the derivative in s is exact and costs no flows.
  bool only_target = false;
};

// Straight lines from `problem` to the same problem with another target, start or time. A line of
// scenes is a function that makes a Dynamics for each s.
ProblemLine moving_target(const BoundaryValueProblem& problem, const std::vector<double>& to);
ProblemLine moving_start(const BoundaryValueProblem& problem, const std::vector<double>& from);
ProblemLine moving_time(const BoundaryValueProblem& problem, double time);

}  // namespace carnot
