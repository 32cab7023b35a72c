// Newton's method on the midpoint transcription: from a nearly tight path to a discrete extremal.
//
// It solves the equations of discrete_equations.h. A step is halved while the residual does not
// fall, or while the path leaves the one chart that it is in. Minimisers and saddles attract alike.
// Measured on sideways parking: with it between relaxation and shooting, shooting converges in 5
// iterations instead of 17 to 25, and 86 % of the starts can be polished instead of 78 %.
#pragma once

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/stop.h"

namespace carnot::internal {

struct DiscreteNewtonOptions {
  int max_iterations = 20;
  double tolerance = 1e-9;  // residual relative to the momenta of the first iterate,
  double scale = 0;         // or to this where it is not zero
  int most_damped = 1000;   // steps that are halved, before it gives up
  double drift = 1;         // see path_lagrangian.h
  // The equations are to leave this share of these numbers; null: zero.
  const std::vector<double>* residual = nullptr;
  double residual_share = 0;
  Stop stop;  // ends it where it is
};

struct DiscreteNewton {
  bool converged = false;   // to the tolerance, or as far as round-off lets it
  bool left_chart = false;  // the last steps were refused since they leave the chart
  double residual = 0;
  int iterations = 0;
};

// Improves q and lambda of `path` and refills its momenta. The ends stay fixed.
DiscreteNewton tighten(const BoundaryValueProblem& problem,
                       const DiscreteNewtonOptions& options,
                       Path& path);

// What the equations of a discrete extremal leave at `path`.
std::vector<double> residual_of(const BoundaryValueProblem& problem, const Path& path);

}  // namespace carnot::internal
