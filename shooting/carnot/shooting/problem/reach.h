// What a drift does, and what controls do against it: sizes for scenes without a transcription.
//
// Along the drift q' = H_p(t, q, 0) from the start, or with the momentum of the straight line where
// H does not exist without momentum, W' = A W + W A' + D with A = dH_p/dq and D = H_pp is the
// controllability Gramian: controls of energy e reach dq with dq' W^-1 dq <= 2 e. It tells how
// coordinates that are not actuated move together with those that are, in the units of the scene.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

struct Reach {
  std::vector<double> rest;  // the momentum of the drift, zero or that of the straight line
  // diag(W) / t after one time scale of the drift: what H_pp would be of controls on each
  // coordinate that move it as far. Of a coordinate that they do not move from there, the mean of
  // H_pp around the straight line.
  std::vector<double> sizes;
  // The integral of the fastest rate of the drift over [0, T]: the spectral radius of A.
  double turns = 0;
};

// The momentum of the velocity of the straight line, made admissible; the velocity itself where
// there is no such momentum.
std::vector<double> straight_momentum(const BoundaryValueProblem& problem);

// From the start of the problem, as far as the drift can be followed.
Reach reach_of(const BoundaryValueProblem& problem);

}  // namespace carnot::internal
