#include "carnot/shooting/problem/ends.h"

#include <cmath>

#include "carnot/numerics/scalar.h"

namespace carnot::internal {

std::vector<double> phase_point(const BoundaryValueProblem& problem, const std::vector<double>& x) {
  std::vector<double> z = problem.from;
  z.resize(2 * z.size(), 0.0);
  for (int j = 0; j < problem.dynamics.dof; ++j) z[start_index(problem, j)] = x[j];
  return z;
}

std::vector<double> start_unknowns(const BoundaryValueProblem& problem, const double* z) {
  std::vector<double> x(problem.dynamics.dof);
  for (int j = 0; j < problem.dynamics.dof; ++j) x[j] = z[start_index(problem, j)];
  return x;
}

BoundaryValueProblem with_ends_moved(const BoundaryValueProblem& problem,
                                     const std::vector<double>& sizes,
                                     std::mt19937_64& random) {
  BoundaryValueProblem moved = problem;
  std::normal_distribution<double> normal;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    const double period = problem.dynamics.info.configuration[j].period;
    const double size = period > 0 ? 0.25 * period : sizes[j];
    if (problem.is_free_from(j)) moved.from[j] += size * normal(random);
    if (problem.is_free_to(j)) moved.to[j] += size * normal(random);
  }
  return moved;
}

double distance_between_ends(const BoundaryValueProblem& problem) {
  double largest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_from(j) || problem.is_free_to(j)) continue;
    largest = maximum(largest, std::abs(problem.from[j] - problem.to[j]));
  }
  return largest;
}

double length_per_momentum(const BoundaryValueProblem& problem, const double* p) {
  double largest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) largest = maximum(largest, std::abs(p[j]));
  const double distance = distance_between_ends(problem);
  return distance > 0 && largest > 0 ? distance / largest : 1;
}

double endpoint_error(const BoundaryValueProblem& problem, const double* z) {
  double largest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (!problem.is_free_to(j)) largest = maximum(largest, std::abs(z[j] - problem.to[j]));
  }
  return largest;
}

double transversality_error(const BoundaryValueProblem& problem, const double* z) {
  double largest = 0;
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_to(j)) largest = maximum(largest, std::abs(z[problem.dynamics.dof + j]));
  }
  return largest;
}

double miss(const BoundaryValueProblem& problem, const double* z, double length_per_momentum) {
  return maximum(endpoint_error(problem, z),
                 length_per_momentum * transversality_error(problem, z));
}

}  // namespace carnot::internal
