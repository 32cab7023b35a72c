// Root finding of the GNU Scientific Library, which is under the GPL.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multiroots.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "benchmark/peers/boundary_peers.h"

namespace carnot::apps {
namespace {

constexpr long kSteps = 32;  // of the method, as many as ours begin with

// q(T) - to, and its derivative, at p0; either may be null.
int end_error(const gsl_vector* p0, void* opaque, gsl_vector* error, gsl_matrix* jacobian) {
  const auto& problem = *static_cast<const BoundaryValueProblem*>(opaque);
  const int n = problem.dynamics.dof;
  std::vector<double> z = problem.from;
  for (int j = 0; j < n; ++j) z.push_back(gsl_vector_get(p0, j));
  std::vector<double> tangent(jacobian != nullptr ? 4 * n * n : 0);
  const StepPlan plan = StepPlan::equal(0, problem.time, kSteps);
  const FlowReport report = jacobian != nullptr ? problem.dynamics.tangent_flow(plan, z, tangent)
                                                : problem.dynamics.flow(plan, z);
  if (!report.completed()) return GSL_EFAILED;
  for (int row = 0; row < n; ++row) {
    if (error != nullptr) gsl_vector_set(error, row, z[row] - problem.to[row]);
    for (int j = 0; jacobian != nullptr && j < n; ++j) {
      gsl_matrix_set(jacobian, row, j, tangent[row * 2 * n + n + j]);
    }
  }
  return GSL_SUCCESS;
}

int function(const gsl_vector* p0, void* problem, gsl_vector* error) {
  return end_error(p0, problem, error, nullptr);
}
int derivative(const gsl_vector* p0, void* problem, gsl_matrix* jacobian) {
  return end_error(p0, problem, nullptr, jacobian);
}
int both(const gsl_vector* p0, void* problem, gsl_vector* error, gsl_matrix* jacobian) {
  return end_error(p0, problem, error, jacobian);
}

}  // namespace

bool solve_with_gsl(const BoundaryValueProblem& problem, std::vector<double>& p0) {
  constexpr int kMostIterations = 200;
  constexpr double kTolerance = 1e-10;  // sum of |q(T) - to|
  gsl_set_error_handler_off();          // it would end the process
  const std::size_t n = p0.size();
  const std::unique_ptr<gsl_multiroot_fdfsolver, decltype(&gsl_multiroot_fdfsolver_free)> solver(
      gsl_multiroot_fdfsolver_alloc(gsl_multiroot_fdfsolver_hybridsj, n),
      gsl_multiroot_fdfsolver_free);
  gsl_multiroot_function_fdf equations{
      function, derivative, both, n, const_cast<BoundaryValueProblem*>(&problem)};
  const gsl_vector_view start = gsl_vector_view_array(p0.data(), n);
  int status = gsl_multiroot_fdfsolver_set(solver.get(), &equations, &start.vector);
  bool converged = false;
  for (int i = 0; i < kMostIterations && status == GSL_SUCCESS && !converged; ++i) {
    status = gsl_multiroot_fdfsolver_iterate(solver.get());
    converged = gsl_multiroot_test_residual(solver->f, kTolerance) == GSL_SUCCESS;
  }
  for (std::size_t j = 0; j < n; ++j) p0[j] = gsl_vector_get(solver->x, j);
  return converged;
}

}  // namespace carnot::apps
