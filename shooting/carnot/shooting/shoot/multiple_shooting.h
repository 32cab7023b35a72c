// Multiple shooting: join short flows into one extremal.
//
// Each flow is short, so |dz(t_{i+1})/dz(t_i)| stays moderate where single shooting sees up to
// 1e16. One segment is single shooting. The zero of the equations (shooting_equations.h) is found
//   newton               by Newton's method on the banded system, with damping,
//   ceres                by Levenberg-Marquardt on their sum of squares; by Newton's method beyond
//                        16 segments, where its dense equations cost too much,
//   nlopt, nlopt:slsqp   by NLopt's SLSQP with the jumps as equality constraints,
//   nlopt:lbfgs          by L-BFGS on the sum of squares, then SLSQP,
//   nlopt:mlsl, nlopt:isres, nlopt:crs   by a global search of a box around p(0), then SLSQP.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

struct ShootingOptions {
  std::string minimiser = "newton";
  int max_iterations = 30;  // NLopt may take twice as many evaluations
  long steps = 32;          // of the method over the whole time; at least one a segment
  double tolerance = 1e-9;  // Euclidean norm of the scaled jumps
  // Whether the knots should be nearly joined. Then newton and ceres give up where kTrials
  // iterations make the jumps hardly smaller, and ceres begins with full steps.
  bool near = true;
  bool own_scales = false;   // whether each momentum has a scale of its own (shooting_equations.h)
  double max_growth = 1e12;  // newton and ceres stop where a scaled tangent flow is larger
  Stop stop{};               // ends it where it is, not converged
};

struct Shooting {
  bool converged = false;
  double residual = 0;  // Euclidean norm of the scaled jumps
  int iterations = 0;
  // Largest entry of the scaled tangent flows: of newton where it ends, of ceres where it begins.
  double growth = 0;
};

// Knots that should be near are given up where after so many iterations the jumps are more than
// this part of the first ones.
inline constexpr int kTrials = 3;
inline constexpr double kHardlySmaller = 0.3;

// Improves `knots` in place. q(0) stays fixed.
Shooting shoot(const BoundaryValueProblem& problem, const ShootingOptions& options, Knots& knots);

// Names accepted by ShootingOptions::minimiser.
std::vector<std::string> names_of_minimisers();

// The ways; `shoot` chooses.
Shooting shoot_with_newton(const BoundaryValueProblem& problem,
                           const ShootingOptions& options,
                           Knots& knots);
Shooting shoot_with_ceres(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots);
Shooting shoot_with_nlopt(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots);

}  // namespace carnot::internal
