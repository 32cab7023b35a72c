// What is unknown at the start of an extremal, and what is asked for at its target.
//
// To first order the action changes by p(T).dq(T) - p(0).dq(0) when the ends of an extremal move.
// So where a coordinate of an end is free, its momentum vanishes there (transversality; Pontryagin
// et al., The Mathematical Theory of Optimal Processes, 1962, sec. 10). In all there are n unknowns
// x and n conditions e = 0:
//
//   x_j = p_j(0), or q_j(0) where that is free and p_j(0) = 0,
//   e_j = q_j(T) - to_j, or p_j(T) where q_j(T) is free.
#pragma once

#include <random>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// Where x_j and e_j stand in a phase point (q, p).
inline int start_index(const BoundaryValueProblem& problem, int j) {
  return problem.is_free_from(j) ? j : problem.dynamics.dof + j;
}
inline int target_index(const BoundaryValueProblem& problem, int j) {
  return problem.is_free_to(j) ? problem.dynamics.dof + j : j;
}
// What is asked for there.
inline double target_value(const BoundaryValueProblem& problem, int j) {
  return problem.is_free_to(j) ? 0 : problem.to[j];
}

// The phase point, 2n, where an extremal with the unknowns x (length n) starts; and back.
std::vector<double> phase_point(const BoundaryValueProblem& problem, const std::vector<double>& x);
std::vector<double> start_unknowns(const BoundaryValueProblem& problem, const double* z);

// The problem with the free coordinates of its ends somewhere else: `sizes` (length n) are the
// standard deviations, a quarter of a turn for angles.
BoundaryValueProblem with_ends_moved(const BoundaryValueProblem& problem,
                                     const std::vector<double>& sizes,
                                     std::mt19937_64& random);

// max |to_j - from_j| over coordinates that are fixed at both ends. NaN where a number is NaN.
double distance_between_ends(const BoundaryValueProblem& problem);

// What one unit of momentum counts as a length, such that the largest of p counts as the distance
// between the ends; 1 where either is zero.
double length_per_momentum(const BoundaryValueProblem& problem, const double* p);

// The largest |q_j(T) - to_j| of fixed coordinates and |p_j(T)| of free ones at the phase point z.
double endpoint_error(const BoundaryValueProblem& problem, const double* z);
double transversality_error(const BoundaryValueProblem& problem, const double* z);
// The larger of both, momenta as lengths.
double miss(const BoundaryValueProblem& problem, const double* z, double length_per_momentum);

}  // namespace carnot::internal
