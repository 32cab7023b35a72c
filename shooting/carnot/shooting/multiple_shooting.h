// Multiple shooting: join short flows into one extremal.
//
// Each flow is short, so |dz(t_{i+1})/dz(t_i)| stays moderate where single shooting sees up to
// 1e16. One segment is single shooting. The zero of the equations (shooting_equations.h) is found
//   ceres                by Levenberg-Marquardt on their sum of squares,
//   nlopt, nlopt:slsqp   by NLopt's SLSQP with the jumps as equality constraints.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/knots.h"

namespace carnot {

struct ShootingOptions {
  std::string minimiser = "ceres";
  int max_iterations = 30;  // of Ceres; NLopt may take twice as many evaluations
  long steps = 32;          // of the method over the whole time; at least one a segment
  double tolerance = 1e-9;  // Euclidean norm of the scaled jumps
};

struct Shooting {
  bool converged = false;
  double residual = 0;  // Euclidean norm of the scaled jumps
  int iterations = 0;
};

// Improves `knots` in place. q(0) stays fixed.
Shooting shoot(const BoundaryValueProblem& problem, const ShootingOptions& options, Knots& knots);

// Names accepted by ShootingOptions::minimiser.
std::vector<std::string> minimisers();

// The two adapters; `shoot` chooses.
Shooting shoot_with_ceres(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots);
Shooting shoot_with_nlopt(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots);

}  // namespace carnot
