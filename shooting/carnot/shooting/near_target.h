// Discrete extremals to targets that are very near, by way of targets that are not.
//
// A displacement of size D against the constraints takes a path of size D^(1/r) with momenta of
// size D^(1/r - 1) or so: the ratio of the scales leaves a penalty method no digits. But the
// extremals to from + s (to - from) form a branch that shrinks with s, and Newton's method
// (discrete_newton.h) follows it from an s that is easy down to 1. What a coordinate shrinks by
// from one s to the next predicts the step after.
#pragma once

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path.h"

namespace carnot {

// How many times further the target of an easy problem is, a power of 2; 1 where `problem` is easy.
double easy_factor(const BoundaryValueProblem& problem);

// The problem with the target `factor` times further away.
BoundaryValueProblem stretched(const BoundaryValueProblem& problem, double factor);

// From a discrete extremal to the target `factor` times further away to one of `problem`. False
// when the branch is lost.
bool shrink(const BoundaryValueProblem& problem, double factor, Path& path);

}  // namespace carnot
