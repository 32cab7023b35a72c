// Discrete extremals of problems with limits, by a primal-dual interior point method on the grid.
//
// To the discrete action of path_lagrangian.h come, at every node that may move, the walls s(q) >=
// 0 (walls.h) with slacks sigma > 0 and multipliers nu > 0. For mu > 0 these solve
//
//   d(sum F_d)/dq_i - h sum nu grad s = 0,     s(q_i) - sigma = 0,     nu sigma = mu,
//
// together with what F_d asks of its own multipliers. A step of Newton's method on all of them is
// one of the banded system with h (nu / sigma) grad s grad s' - h nu s'' added to the blocks of the
// nodes, for slacks and multipliers go out point by point. Steps end before a slack or a multiplier
// vanishes, and mu is lowered to its end as the equations are met (Waechter & Biegler, Math.
// Program. 106 (2006), sec. 2 and 3). A path may start beyond the walls.
//
// The error of the action is about mu T for each wall that the path keeps to, and that of the grid.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/walls.h"

namespace carnot::internal {

struct InteriorPointOptions {
  double first_mu = 1e-2;  // in units of an action over a time
  double last_mu = 1e-9;
  double rate = 1;            // that action over that time
  std::vector<double> sizes;  // of the walls: a slack of that size is large
  double tolerance = 1e-8;    // of all equations, relative
  int max_iterations = 100;
};

// A path with slacks and multipliers, nodes x walls.
struct LimitedPath {
  Path path;
  std::vector<double> sigma;  // empty: none are known
  std::vector<double> nu;
};

struct InteriorPoint {
  bool converged = false;
  bool minimum =
      false;  // no direction that the walls leave open lowers the action, to second order
  int iterations = 0;
  double mu = 0;  // reached
  double residual = 0;
};

// Solves for mu = last_mu from `limited`, in place. Where it has no slacks they are made of s and
// mu.
InteriorPoint interior_point(const BoundaryValueProblem& problem,
                             const Walls& walls,
                             const InteriorPointOptions& options,
                             LimitedPath& limited);

}  // namespace carnot::internal
