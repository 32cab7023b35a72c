// Least squares on a chain of nodes: residuals number i depend on nodes i and i + 1 only.
//
// The method of Levenberg and Marquardt. The normal equations are banded, so an iteration costs
// little more than its Jacobians; a general sparse solver spends several times as much on finding
// the structure. The damping is that of Ceres: D = diag(J'J) / radius, bounded below in units of
// the first Jacobian's columns, and the radius follows the ratio of the true to the predicted gain
// (Madsen, Nielsen & Tingleff, Methods for Non-Linear Least Squares Problems, 2004, 3.2).
#pragma once

#include <functional>
#include <vector>

namespace carnot::internal {

struct ChainOptions {
  int max_iterations = 12;
  double radius = 1e4;               // at first; larger: nearer to Gauss and Newton's method
  double function_tolerance = 1e-4;  // gain relative to the cost,
  double step_tolerance = 1e-6;      // and step relative to the nodes, at which to stop
  double gradient_tolerance = 1e-8;
  // Which numbers of the first and of the last node may move; empty: none.
  std::vector<bool> free_first;
  std::vector<bool> free_last;
};

// How many intervals are evaluated side by side.
inline constexpr int kChainLanes = 8;

// The residuals of `count` intervals from `first` on, at the nodes x_first, ..., and unless null
// their Jacobian by (x_i, x_{i+1}), `residuals` x 2n row-major. Number r of interval first + l is
// at r * kChainLanes + l; what is beyond `count` is not read. False where there are none.
using ChainResiduals =
    std::function<bool(int first, int count, const double* x, double* residual, double* jacobian)>;

// Improves the inner nodes of `x`, (intervals + 1) x n row-major, and what is free of the end
// nodes. Returns the number of iterations; 0 where there is nothing to improve, or no residuals to
// start with.
int minimise_chain(const ChainResiduals& residuals_of,
                   int residuals,
                   int n,
                   const ChainOptions& options,
                   std::vector<double>& x);

}  // namespace carnot::internal
