#include "carnot/shooting/near_target.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/discrete_newton.h"
#include "carnot/shooting/starts.h"

namespace carnot {
namespace {

// Where coordinate j is beside the straight line to the end of the path, at node i.
double beside(const BoundaryValueProblem& problem, const Path& path, int i, int j) {
  const double end = path.configuration(path.intervals)[j];
  return path.configuration(i)[j] - problem.from[j] - i * (end - problem.from[j]) / path.intervals;
}

double extent_beside(const BoundaryValueProblem& problem, const Path& path, int j) {
  double extent = 0;
  for (int i = 0; i <= path.intervals; ++i) {
    extent = std::max(extent, std::abs(beside(problem, path, i, j)));
  }
  return extent;
}

}  // namespace

double easy_factor(const BoundaryValueProblem& problem) {
  constexpr double kEasy = 0.02;  // D / S of starts.h
  const StartScales scales = start_scales(problem);
  const bool against = scales.violation > 0.1 * scales.distance;
  if (!against || !(scales.distance > 0)) return 1;
  double factor = 1;
  while (factor * scales.distance < kEasy * scales.radian) factor *= 2;
  return factor;
}

BoundaryValueProblem stretched(const BoundaryValueProblem& problem, double factor) {
  BoundaryValueProblem far = problem;
  for (std::size_t j = 0; j < far.to.size(); ++j) {
    far.to[j] = far.from[j] + factor * (problem.to[j] - problem.from[j]);
  }
  return far;
}

bool shrink(const BoundaryValueProblem& problem, double factor, Path& path) {
  constexpr double kShrinks = 0.7;  // per halving of the target, before it is known
  const int n = path.dof;
  std::vector<double> ratio(n, kShrinks);
  while (factor > 1) {
    factor /= 2;
    const BoundaryValueProblem nearer = stretched(problem, factor);
    Path trial = path;
    for (int j = 0; j < n; ++j) {
      const double end = factor > 1 ? nearer.to[j] : problem.to[j];
      for (int i = 1; i <= path.intervals; ++i) {
        const double line = problem.from[j] + i * (end - problem.from[j]) / path.intervals;
        trial.configuration(i)[j] = line + ratio[j] * beside(problem, path, i, j);
      }
      trial.configuration(path.intervals)[j] = end;
    }
    DiscreteNewtonOptions newton;
    newton.max_iterations = 30;
    if (!tighten(nearer, newton, trial).converged) return false;
    for (int j = 0; j < n; ++j) {
      const double before = extent_beside(problem, path, j);
      if (before > 0) {
        ratio[j] = std::clamp(extent_beside(problem, trial, j) / before, 0.2, 1.0);
      }
    }
    path = std::move(trial);
  }
  return true;
}

}  // namespace carnot
