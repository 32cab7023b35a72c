// Newton's method on the midpoint transcription for several paths side by side.
//
// It is the method of discrete_newton.h, with another elimination: the unknowns are ordered q_1,
// lambda_0, q_2, lambda_1, ..., so that the pivots of each constraint come after those of a node
// that it holds, and the symmetric matrix is factored without exchanges. That is not stable in
// general. Where a factor has so large a number that half of the digits are lost, the path is
// tightened by discrete_newton.h from the start. Where several steps in vain say that it may come
// to nothing, it goes on there from where it is, so that the other lanes need not wait for it.
#pragma once

#include <span>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

struct TighteningTask {
  Path* path;
  DiscreteNewton result;
};

// Tightens paths of as many intervals; the dynamics have a transcription. What becomes of a path
// does not depend on the others. Of the options those of the iteration are used.
void tighten(const BoundaryValueProblem& problem,
             const DiscreteNewtonOptions& options,
             std::span<TighteningTask> tasks);

}  // namespace carnot::internal
