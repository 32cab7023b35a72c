#include "carnot/shooting/path/discrete_newton.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/linear/norm.h"
#include "carnot/shooting/path/discrete_equations.h"

namespace carnot::internal {

std::vector<double> residual_of(const BoundaryValueProblem& problem, const Path& path) {
  DiscreteEquations equations(problem, path.intervals);
  std::vector<double> residual;
  equations.evaluate(path, residual, nullptr);
  return residual;
}

DiscreteNewton tighten(const BoundaryValueProblem& problem,
                       const DiscreteNewtonOptions& options,
                       Path& path) {
  // A residual that no step makes smaller is round-off up to here: that of coordinates far from
  // zero, magnified near singular frames.
  constexpr double kRoundedOff = 1e-6;
  const double h = problem.time / path.intervals;
  DiscreteEquations equations(problem, path.intervals, options.drift);
  BandedLu matrix = equations.matrix();
  std::vector<double> residual;
  const auto evaluate = [&](const Path& at, BandedLu* into) {
    const double largest = equations.evaluate(at, residual, into);
    for (std::size_t j = 0; options.residual != nullptr && j < residual.size(); ++j) {
      residual[j] -= options.residual_share * (*options.residual)[j];
    }
    return largest;
  };
  std::vector<double> direction;
  std::vector<double> simplified;
  Path trial = path;
  const bool walled = in_one_chart(problem.dynamics, path);
  constexpr double kShortestStep = 1.0 / 64;
  DiscreteNewton result;
  int damped = 0;
  const double scale = evaluate(path, &matrix);
  result.residual = norm(residual);
  const auto is_solution = [&] { return result.residual <= options.tolerance * scale; };
  while (result.iterations < options.max_iterations && std::isfinite(result.residual)) {
    result.converged = is_solution();
    if (result.converged || options.stop.reached()) break;
    ++result.iterations;
    if (!matrix.factor()) break;
    direction = residual;
    matrix.substitute(direction);
    const double length = norm(direction);
    double step = 1;
    double reached = 0;
    for (; step >= kShortestStep; step *= 0.5) {
      equations.move(path, direction, step, trial);
      result.left_chart = walled && !in_one_chart(problem.dynamics, trial);
      if (result.left_chart) continue;
      evaluate(trial, nullptr);
      reached = norm(residual);
      if (reached < (1 - 0.1 * step) * result.residual) break;
      simplified = residual;
      matrix.substitute(simplified);
      if (norm(simplified) < (1 - 0.25 * step) * length) break;
    }
    if (step < 1 && ++damped > options.most_damped) break;
    if (step < kShortestStep) {
      result.converged = !result.left_chart && result.residual <= kRoundedOff * scale;
      break;
    }
    std::swap(path.q, trial.q);
    std::swap(path.lambda, trial.lambda);
    result.residual = reached;
    if (!is_solution()) evaluate(path, &matrix);
  }
  fill_momenta(problem.dynamics, h, path);
  return result;
}

}  // namespace carnot::internal
