// Path relaxation: pull a path tight, read off a costate.
//
// The action of the midpoint transcription, sum_i h L(qm_i, v_i), is minimised subject to
// G(qm_i) v_i = 0 by an augmented Lagrangian. With multipliers lambda_i and a weight rho this is
//
//   sum_i h [ L - lambda.G v + rho |G v|^2 / 2 ],      lambda <- lambda - rho G v.
//
// Each inner problem is a sum of squares on a chain of nodes (chain_least_squares.h). At the
// solution lambda are the multipliers, and -D1 F_d is the momentum, of the midpoint rule itself
// (lib: midpoint_transcription.h), so that shooting starts from a discrete extremal. A potential
// enters as sqrt(2 (c - V)) with c above V along the path. What is beyond a wall of a limit
// (walls.h) costs rate (s / size)^2 / 2, for s < 0.
#pragma once

#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

struct RelaxationOptions {
  int outer_iterations = 8;   // updates of the multipliers
  int inner_iterations = 16;  // least-squares iterations between two of them
  double penalty = 10;        // rho relative to the mass
  double caution = 1e-4;      // first damping: larger keeps to the valley where the path starts
  double feasibility = 1e-3;  // |G v| / |v| at which to stop
  // With limits: the rate of action of a path that is beyond a wall by one of these sizes.
  double wall_rate = 0;
  std::vector<double> wall_sizes;
};

struct Relaxation {
  bool feasible = false;  // constraints met to options.feasibility
  double action = 0;      // of the transcription
  double violation = 0;   // max |G v| / max |v|
  int iterations = 0;
};

struct RelaxationTask {
  RelaxationOptions options;  // inner_iterations are the same for all of a call
  Path* path;
  Relaxation result;
};

// Relaxes paths of as many intervals in place, side by side in lanes (chain_least_squares.h). The
// results are to the last bit those of one by one, which takes five times as long.
void relax(const BoundaryValueProblem& problem, std::span<RelaxationTask> tasks);

// Relaxes `path` in place, without its momenta. What is fixed of the ends stays so. Starts from the
// multipliers of the path, or from zeros where it has none.
Relaxation relax(const BoundaryValueProblem& problem, const RelaxationOptions& options, Path& path);

}  // namespace carnot::internal
