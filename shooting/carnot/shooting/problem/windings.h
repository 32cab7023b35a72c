// The images of a target on the cover: angles that agree modulo their periods.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// A target with whole periods added, windings[j] of them to coordinate j.
struct Image {
  std::vector<double> to;
  std::vector<int> windings;
};

// Images of problem.to, those of the shorter straight lines first; at most kMostImages. Each angle
// turns by at most a whole period or, where that is more, by what a path of `max_length` can turn
// it when the straight line in that coordinate alone is the cheapest way.
inline constexpr int kMostImages = 27;
std::vector<Image> images_of_target(const BoundaryValueProblem& problem, double max_length);

}  // namespace carnot::internal
