#include "carnot/shooting/problem/origin.h"

namespace carnot::internal {

std::vector<int> movable(const SceneInfo& info) {
  std::vector<int> coordinates = info.symmetries.cyclic;
  for (const int j : {info.symmetries.x, info.symmetries.y}) {
    if (j >= 0) coordinates.push_back(j);
  }
  return coordinates;
}

BoundaryValueProblem at_origin(const BoundaryValueProblem& problem) {
  BoundaryValueProblem moved = problem;
  for (const int j : movable(problem.dynamics.info)) {
    moved.to[j] -= moved.from[j];
    moved.from[j] = 0;
  }
  return moved;
}

}  // namespace carnot::internal
