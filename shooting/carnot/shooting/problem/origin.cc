#include "carnot/shooting/problem/origin.h"

namespace carnot::internal {

std::vector<int> movable(const SceneInfo& info) {
  std::vector<int> coordinates = info.symmetries.cyclic;
  for (const int j : {info.symmetries.x, info.symmetries.y}) {
    if (j >= 0) coordinates.push_back(j);
  }
  return coordinates;
}

std::vector<double> origin_of(const BoundaryValueProblem& problem) {
  std::vector<double> origin(problem.from.size(), 0.0);
  for (const int j : movable(problem.dynamics.info)) {
    origin[j] = problem.is_free_from(j) ? problem.to[j] : problem.from[j];
  }
  return origin;
}

BoundaryValueProblem at_origin(const BoundaryValueProblem& problem) {
  BoundaryValueProblem moved = problem;
  const std::vector<double> origin = origin_of(problem);
  for (std::size_t j = 0; j < origin.size(); ++j) {
    moved.to[j] -= origin[j];
    moved.from[j] -= origin[j];
  }
  return moved;
}

}  // namespace carnot::internal
