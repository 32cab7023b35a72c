// Less action, and smaller defects, of a path that need not satisfy the dynamics.
//
// For scenes of any kind, without a transcription of their own. A path has configurations q_i at
// its nodes and momenta s_i on its intervals; a momentum stands for the controls that are best for
// it. With the middle qm and the velocity v of an interval of length h, the problem is
//
//   minimise  sum h l(qm, s)   subject to   v = H_p(qm, s),   l = s.H_p - H.
//
// Where the multiplier of a defect v - H_p is s itself, the second derivatives of the Lagrange
// function by (qm, s) are diag(-H_qq, H_pp), and a step of sequential quadratic programming is one
// of Newton's method on
//
//   F(q, s) = sum h [s.v - H(qm, s)]   (path_lagrangian.h).
//
// It is a descent direction where the Hessian of F has as many negative eigenvalues as there are
// momenta. (The quadratic programme with multipliers p of their own has the Hessian of F by (q, p)
// and, apart from it, the form of H_pp in s - p.) Until it has, multiples of a diagonal matrix are
// added to the block of the nodes. Steps are damped by the exact penalty function
// sum h (l + sum_j nu_j |v - H_p|_j), nu_j above the largest momentum, after a second-order
// correction where the curvature of the dynamics spoils a full step (Nocedal & Wright, Numerical
// Optimization, 2006, sec. 18.3).
//
// A relaxation gives every coordinate a fictitious control w of its own, v = H_p + w, at the cost
// -c.w + |w|^2 / (2 mu S). This only adds mu (s - c)'S (s - c) / 2 to H. With c = s from the last
// solution, and so on, it is the method of multipliers.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/stop.h"

namespace carnot::internal {

struct ActionDescentOptions {
  int max_iterations = 100;
  double tolerance = 1e-6;     // of defects and forces, relative to velocities and momenta
  double relaxation = 0;       // mu
  std::vector<double> centre;  // c, intervals x n; empty: zero
  std::vector<double> rest;    // the momentum to begin with where the path has none
  Stop stop;                   // ends it where it is
  std::vector<double> sizes;   // S, of length n: what H_pp would be of controls on all coordinates
};

struct ActionDescent {
  bool converged = false;
  bool left_chart = false;  // the last steps were refused since they leave the chart
  int iterations = 0;
  double residual = 0;  // as the tolerance
};

// Moves the inner nodes of `path`, what is free of its ends, and its momenta, path.lambda. Where
// that is empty, it is first set to the momenta that suit the velocities.
ActionDescent reduce_action(const BoundaryValueProblem& problem,
                            const ActionDescentOptions& options,
                            Path& path);

}  // namespace carnot::internal
