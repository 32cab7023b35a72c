#include "carnot/shooting/path/discrete_newton.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/linear/norm.h"
#include "carnot/shooting/path/discrete_equations.h"
#include "carnot/shooting/path/newton_step.h"

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
  DiscreteNewton result;
  int damped = 0;
  const double largest = evaluate(path, &matrix);
  const double scale = options.scale > 0 ? options.scale : largest;
  result.residual = norm(residual);
  const auto is_solution = [&] { return result.residual <= options.tolerance * scale; };
  while (std::isfinite(result.residual)) {
    result.converged = is_solution();
    if (result.converged || result.iterations >= options.max_iterations) break;
    if (options.stop.reached()) break;
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
      if (makes_fall(step, result.residual, reached)) break;
      simplified = residual;
      matrix.substitute(simplified);
      if (makes_shorter(step, length, norm(simplified))) break;
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
