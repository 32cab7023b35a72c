#include "carnot/shooting/relaxation.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

namespace carnot {
namespace {

// What all intervals share.
struct Transcription {
  const Segment& segment;
  double h;
  double rho;
  double ceiling;  // c > V; used where the scene has a potential
  bool potential;
};

// One interval: parameters q0, q1; residuals sqrt(h) r, sqrt(h rho) (G v - lambda / rho) and, with
// a potential, sqrt(2 h (c - V)).
class Interval final : public ceres::CostFunction {
 public:
  Interval(const Transcription& shared, const double* lambda) : shared_(shared), lambda_(lambda) {
    const int n = shared.segment.dof;
    set_num_residuals(n + shared.segment.transcribed + (shared.potential ? 1 : 0));
    *mutable_parameter_block_sizes() = {n, n};
    qm_.resize(n);
    v_.resize(n);
    terms_.resize(n + shared.segment.transcribed + 1);
    jacobian_.resize(terms_.size() * 2 * n);
  }

  bool Evaluate(double const* const* q, double* residuals, double** jacobians) const override {
    const int n = shared_.segment.dof;
    for (int i = 0; i < n; ++i) {
      qm_[i] = 0.5 * (q[0][i] + q[1][i]);
      v_[i] = (q[1][i] - q[0][i]) / shared_.h;
    }
    double* derivative = jacobians != nullptr ? jacobian_.data() : nullptr;
    if (!shared_.segment.midpoint(qm_.data(), v_.data(), terms_.data(), derivative)) return false;
    for (int row = 0; row < num_residuals(); ++row) {
      const double weight = scale(row, residuals);
      if (!std::isfinite(weight) || !std::isfinite(residuals[row])) return false;
      if (jacobians == nullptr) continue;
      const double* d = jacobian_.data() + row * 2 * n;
      for (int i = 0; i < n; ++i) {
        const double by_q = 0.5 * weight * d[i];
        const double by_v = weight * d[n + i] / shared_.h;
        if (jacobians[0] != nullptr) jacobians[0][row * n + i] = by_q - by_v;
        if (jacobians[1] != nullptr) jacobians[1][row * n + i] = by_q + by_v;
      }
    }
    return true;
  }

 private:
  // Sets residual `row` from the terms, returns d residual / d term.
  double scale(int row, double* residuals) const {
    const int n = shared_.segment.dof;
    if (row < n) {
      const double weight = std::sqrt(shared_.h);
      residuals[row] = weight * terms_[row];
      return weight;
    }
    if (row < n + shared_.segment.transcribed) {
      const double weight = std::sqrt(shared_.h * shared_.rho);
      residuals[row] = weight * (terms_[row] - lambda_[row - n] / shared_.rho);
      return weight;
    }
    residuals[row] = std::sqrt(2 * shared_.h * (shared_.ceiling - terms_[row]));
    return -shared_.h / residuals[row];
  }

  const Transcription& shared_;
  const double* lambda_;
  mutable std::vector<double> qm_;
  mutable std::vector<double> v_;
  mutable std::vector<double> terms_;
  mutable std::vector<double> jacobian_;
};

// Reads the terms of all intervals of a path.
struct PathTerms {
  double action = 0;
  double violation = 0;
  double max_potential = 0;
  double mass = 0;  // mean |r|^2 / |v|^2
  bool potential = false;
  std::vector<double> constraint;  // intervals x k
};

PathTerms terms_of(const Segment& segment, double h, const Path& path) {
  const int n = segment.dof;
  const int k = segment.transcribed;
  PathTerms result;
  std::vector<double> qm(n), v(n), terms(n + k + 1);
  double largest_speed = 0;
  double largest_constraint = 0;
  double kinetic = 0;
  double speed = 0;
  for (int i = 0; i < path.intervals; ++i) {
    double v2 = 0;
    for (int j = 0; j < n; ++j) {
      qm[j] = 0.5 * (path.configuration(i)[j] + path.configuration(i + 1)[j]);
      v[j] = (path.configuration(i + 1)[j] - path.configuration(i)[j]) / h;
      v2 += v[j] * v[j];
    }
    if (!segment.midpoint(qm.data(), v.data(), terms.data(), nullptr)) continue;
    double r2 = 0;
    double c2 = 0;
    for (int j = 0; j < n; ++j) r2 += terms[j] * terms[j];
    for (int j = 0; j < k; ++j) c2 += terms[n + j] * terms[n + j];
    result.constraint.insert(result.constraint.end(), terms.begin() + n, terms.begin() + n + k);
    result.action += h * (0.5 * r2 - terms[n + k]);
    kinetic += r2;
    speed += v2;
    largest_speed = std::max(largest_speed, std::sqrt(v2));
    largest_constraint = std::max(largest_constraint, std::sqrt(c2));
    result.max_potential = i == 0 ? terms[n + k] : std::max(result.max_potential, terms[n + k]);
    result.potential = result.potential || terms[n + k] != 0;
  }
  result.violation = largest_speed > 0 ? largest_constraint / largest_speed : 0;
  result.mass = speed > 0 ? kinetic / speed : 1;
  return result;
}

ceres::Solver::Options inner_options(const RelaxationOptions& options) {
  ceres::Solver::Options inner;
  inner.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  inner.max_num_iterations = options.inner_iterations;
  inner.function_tolerance = 1e-4;
  inner.gradient_tolerance = 1e-8;
  inner.parameter_tolerance = 1e-6;
  inner.initial_trust_region_radius = 1 / options.caution;
  inner.num_threads = 1;
  inner.logging_type = ceres::SILENT;
  return inner;
}

}  // namespace

Relaxation relax(const BoundaryValueProblem& problem,
                 const RelaxationOptions& options,
                 Path& path) {
  const Segment& segment = problem.segment;
  const double h = problem.time / path.intervals;
  PathTerms state = terms_of(segment, h, path);
  const double spread = 1 + std::abs(state.max_potential);
  Transcription shared{
      segment, h, options.penalty * state.mass, state.max_potential + spread, state.potential};
  path.lambda.resize(static_cast<std::size_t>(path.intervals) * segment.transcribed, 0.0);
  std::vector<double>& lambda = path.lambda;

  Relaxation result;
  // Ceres would log an error where the first evaluation fails; a library must not print.
  if (state.constraint.size() != lambda.size() || !std::isfinite(state.action)) return result;
  ceres::Problem::Options ownership;
  ownership.enable_fast_removal = false;
  ceres::Problem least_squares(ownership);
  for (int i = 0; i < path.intervals; ++i) {
    least_squares.AddResidualBlock(new Interval(shared, lambda.data() + i * segment.transcribed),
                                   nullptr,
                                   path.configuration(i),
                                   path.configuration(i + 1));
  }
  least_squares.SetParameterBlockConstant(path.configuration(0));
  least_squares.SetParameterBlockConstant(path.configuration(path.intervals));

  for (int outer = 0; outer < options.outer_iterations; ++outer) {
    ceres::Solver::Summary summary;
    ceres::Solve(inner_options(options), &least_squares, &summary);
    result.iterations += static_cast<int>(summary.iterations.size());
    if (summary.termination_type == ceres::FAILURE) break;
    state = terms_of(segment, h, path);
    if (state.constraint.size() != lambda.size()) break;
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] -= shared.rho * state.constraint[i];
    if (state.violation < options.feasibility) break;
  }
  result.action = state.action;
  result.violation = state.violation;
  result.feasible = state.violation < options.feasibility;
  fill_momenta(segment, h, path);
  return result;
}

}  // namespace carnot
