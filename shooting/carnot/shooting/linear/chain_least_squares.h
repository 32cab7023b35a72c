// Least squares on chains of nodes: residuals number i depend on nodes i and i + 1 only.
//
// The method of Levenberg and Marquardt, for as many chains of one length at a time as there are
// lanes. Each lane goes its own way, to the last bit the same whatever stands beside it, and takes
// up the next chain when it has done with one. The normal equations are banded, so an iteration
// costs little more than its Jacobians; a general sparse solver spends several times as much on
// finding the structure. The damping is that of Ceres: D = diag(J'J) / radius, bounded below in
// units of the first Jacobian's columns, and the radius follows the ratio of the true to the
// predicted gain (Madsen, Nielsen & Tingleff, Methods for Non-Linear Least Squares Problems, 2004,
// 3.2).
#pragma once

#include <functional>
#include <vector>

namespace carnot::internal {

// How many chains are minimised side by side.
inline constexpr int kChainLanes = 8;

struct ChainOptions {
  int max_iterations = 12;
  double function_tolerance = 1e-4;  // gain relative to the cost,
  double step_tolerance = 1e-6;      // and step relative to the nodes, at which to stop
  double gradient_tolerance = 1e-8;
  // Which numbers of the first and of the last node may move; empty: none.
  std::vector<bool> free_first;
  std::vector<bool> free_last;
};

// What chains have in common.
struct ChainShape {
  int intervals;
  int n;          // numbers of a node
  int residuals;  // of an interval
};

// The residuals of interval i of every lane at its nodes i and i + 1, and their Jacobian by both,
// `residuals` x 2n row-major. A number of lane l stands l places after that of lane 0, and the next
// number kChainLanes places after it. What does not exist is not finite.
using ChainResiduals =
    std::function<void(int i, const double* nodes, double* residual, double* jacobian)>;

// Takes what a lane has come to, (intervals + 1) x n numbers row-major, after `iterations`, and
// puts the next chain in its place. Returns the first radius, which is larger the nearer it is to
// begin with to Gauss and Newton's method; 0 where there is nothing more for this lane to do. The
// first call finds nothing.
using NextChain = std::function<double(int lane, int iterations, std::vector<double>& nodes)>;

// Moves the inner nodes, and what is free of the end nodes, until no lane has anything to do.
// An iteration count of 0 says that there was nothing to improve, or no residuals to start with.
void minimise_chains(const ChainResiduals& residuals_of,
                     const ChainShape& shape,
                     const ChainOptions& options,
                     const NextChain& next);

}  // namespace carnot::internal
