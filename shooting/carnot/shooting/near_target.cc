#include "carnot/shooting/near_target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/discrete_newton.h"
#include "carnot/shooting/relaxation.h"
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

// A discrete extremal near `path`: by Newton's method or, where the path is too far from the
// constraints for it, by relaxing first. Away from the origin coordinates that brackets move shrink
// at several rates at once.
bool settle(const BoundaryValueProblem& problem, Path& path) {
  DiscreteNewtonOptions newton;
  newton.max_iterations = 30;
  Path trial = path;
  bool settled = tighten(problem, newton, trial).converged;
  if (!settled) {
    RelaxationOptions relaxation;
    relaxation.outer_iterations = 4;
    relaxation.penalty = 100;
    trial = path;
    relax(problem, relaxation, trial);
    settled = tighten(problem, newton, trial).converged;
  }
  if (settled) path = std::move(trial);
  return settled;
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
  constexpr double kShrinks = 0.5;  // exponent of a wiggle in the distance, before it is known
  constexpr double kLongest = 0.5;  // step of the target, as a factor,
  constexpr double kShortest = 0.9;
  const int n = path.dof;
  std::vector<double> exponent(n, kShrinks);
  for (double step = kLongest; factor > 1;) {
    const double next = std::max(1.0, factor * step);
    const BoundaryValueProblem nearer = next > 1 ? stretched(problem, next) : problem;
    Path trial = path;
    for (int j = 0; j < n; ++j) {
      const double ratio = std::pow(next / factor, exponent[j]);
      for (int i = 1; i <= path.intervals; ++i) {
        const double line = problem.from[j] + i * (nearer.to[j] - problem.from[j]) / path.intervals;
        trial.configuration(i)[j] = line + ratio * beside(problem, path, i, j);
      }
      trial.configuration(path.intervals)[j] = nearer.to[j];
    }
    if (!settle(nearer, trial)) {
      if (step > kShortest) return false;
      step = std::sqrt(step);
      continue;
    }
    for (int j = 0; j < n; ++j) {
      const double ratio = extent_beside(problem, trial, j) / extent_beside(problem, path, j);
      if (!(ratio > 0)) continue;  // or not a number, where there was none
      exponent[j] = std::clamp(std::log(ratio) / std::log(next / factor), 0.0, 2.3);
    }
    path = std::move(trial);
    factor = next;
    step = std::max(kLongest, step * step);
  }
  return true;
}

}  // namespace carnot
