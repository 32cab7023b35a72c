// Multiple shooting by Ceres: one residual block a segment.
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/shooting_equations.h"

namespace carnot::internal {
namespace {

// The equations of a segment where the search begins: at z, its knots.
struct Beginning {
  std::vector<double> z;
  std::vector<double> residual;
  std::vector<double> jacobian;
};

// Of all segments; none where a flow or its tangent fails.
std::vector<Beginning> begin(const ShootingEquations& equations, const Knots& knots) {
  const int n = knots.dof;
  std::vector<Beginning> all;
  for (int i = 0; i < knots.segments; ++i) {
    Beginning one;
    one.z.assign(knots.at(i), knots.at(i) + (i + 1 == knots.segments ? 2 : 4) * n);
    one.residual.resize(2 * n);
    one.jacobian.resize(4 * n * n);
    if (!equations.evaluate(
            i, knots.at(i), knots.at(i + 1), one.residual.data(), one.jacobian.data())) {
      return {};
    }
    all.push_back(std::move(one));
  }
  return all;
}

// What the segments tell of the search that they are all part of.
struct Course {
  double tolerance;
  bool lost = false;            // derivatives failed, or the search is stopped
  std::vector<double> squares;  // of the residuals of each segment where Ceres tried last

  // Whether the knots are joined there, so that the search ends.
  [[nodiscard]] bool joined() const {
    constexpr double kSurely = 0.5;  // whatever order Ceres sums up in
    return std::accumulate(squares.begin(), squares.end(), 0.0) < kSurely * tolerance * tolerance;
  }
};

// Parameter blocks: q_i, p_i and, but for the last segment, q_{i+1}, p_{i+1}.
//
// Ceres prints an error where its first evaluation fails, and where derivatives fail at a place
// that it has stepped to. A library must not print. So the first evaluation is made before, and
// derivatives that fail are told by `lost`, with zeros in their place. So is a search that is
// stopped; its residuals are large.
//
// Ceres asks for derivatives wherever it has stepped to. Where the knots are joined nothing is done
// with them, and there are zeros in their place, too: polishing takes two evaluations of them in
// place of three.
class Jump final : public ceres::CostFunction {
 public:
  Jump(const ShootingEquations& equations, int i, Beginning beginning, Course& course)
      : equations_(equations), i_(i), beginning_(std::move(beginning)), course_(course) {
    const int n = equations.dof();
    const int blocks = i + 1 == equations.segments() ? 2 : 4;
    mutable_parameter_block_sizes()->assign(blocks, n);
    set_num_residuals(equations.residuals(i));
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const int n = equations_.dof();
    const int blocks = static_cast<int>(parameter_block_sizes().size());
    std::vector<double> z;
    for (int b = 0; b < blocks; ++b) z.insert(z.end(), x[b], x[b] + n);
    std::vector<double> jacobian(jacobians != nullptr ? num_residuals() * 2 * n : 0);
    if (z == beginning_.z) {
      std::copy_n(beginning_.residual.begin(), num_residuals(), residuals);
      jacobian = beginning_.jacobian;
    } else if (jacobians != nullptr && z == tried_.z && course_.joined()) {
      std::copy_n(tried_.residual.begin(), num_residuals(), residuals);
    } else if (!equations_.evaluate(i_,
                                    z.data(),
                                    z.data() + 2 * n,
                                    residuals,
                                    jacobians != nullptr ? jacobian.data() : nullptr)) {
      const bool flows = jacobians != nullptr &&
                         equations_.evaluate(i_, z.data(), z.data() + 2 * n, residuals, nullptr);
      if (!flows && !equations_.stopped()) return false;
      if (!flows) std::fill_n(residuals, num_residuals(), kStopped);
      course_.lost = true;
      std::fill(jacobian.begin(), jacobian.end(), 0.0);
    }
    if (jacobians == nullptr) note(std::move(z), residuals);
    for (int b = 0; jacobians != nullptr && b < blocks; ++b) {
      if (jacobians[b] == nullptr) continue;
      for (int row = 0; row < num_residuals(); ++row) {
        for (int j = 0; j < n; ++j) {
          const bool same = row == (b - 2) * n + j;  // of the next knot; b < 2: of this one
          const double diagonal = same ? -1 / equations_.scale(row) : 0;
          jacobians[b][row * n + j] = b < 2 ? jacobian[row * 2 * n + b * n + j] : diagonal;
        }
      }
    }
    return true;
  }

 private:
  static constexpr double kStopped = 1e3;

  void note(std::vector<double> z, const double* residuals) const {
    tried_.z = std::move(z);
    tried_.residual.assign(residuals, residuals + num_residuals());
    double& square = course_.squares[static_cast<std::size_t>(i_)];
    square = 0;
    for (const double r : tried_.residual) square += r * r;
  }

  const ShootingEquations& equations_;
  int i_;
  Beginning beginning_;
  mutable Beginning tried_;  // without derivatives
  Course& course_;
};

// Stops when the jumps are below the tolerance, when they are far from that and hardly fall, or
// when there are no derivatives to go on with.
class StopWhenJoined final : public ceres::IterationCallback {
 public:
  StopWhenJoined(const ShootingOptions& options, const Course& course)
      : cost_(0.5 * options.tolerance * options.tolerance), near_(options.near), course_(course) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) first_ = summary.cost;
    if (summary.cost <= cost_) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    if (course_.lost) return ceres::SOLVER_ABORT;
    const bool hardly_falls = near_ && summary.cost > kHardlySmaller * kHardlySmaller * first_;
    return summary.iteration == kTrials && hardly_falls ? ceres::SOLVER_ABORT
                                                        : ceres::SOLVER_CONTINUE;
  }

 private:
  double cost_;
  bool near_;
  const Course& course_;
  double first_ = 0;
};

ceres::Solver::Options solver_options(const BoundaryValueProblem& problem,
                                      const ShootingOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_QR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 0;
  solver.gradient_tolerance = 0;
  solver.parameter_tolerance = 1e-15;
  // Where the knots are nearly joined, steps are those of Newton's method. Measured on trailer2 to
  // targets 15 away: with a radius of 1e6 a shoot takes 2.9 steps in place of 2.3, more of them do
  // not arrive, and what is done about that takes a quarter of a search.
  // Momenta along the rows of Dh move nothing: columns of zeros that need a diagonal. Ceres divides
  // it by the radius, which is not large there.
  const bool degenerate = problem.dynamics.forced > 0;
  solver.initial_trust_region_radius = options.near && !degenerate ? 1e12 : 1e6;
  if (degenerate) solver.min_lm_diagonal = 1e-2;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

// Keeps what is not unknown at the start: q(0), or p_j(0) where q_j(0) is free.
void hold_start(const BoundaryValueProblem& problem, Knots& knots, ceres::Problem& joined) {
  const int n = knots.dof;
  std::vector<int> configuration;
  std::vector<int> momentum;
  for (int j = 0; j < n; ++j) (problem.is_free_from(j) ? momentum : configuration).push_back(j);
  double* block = knots.at(0);
  for (const std::vector<int>* fixed : {&configuration, &momentum}) {
    if (static_cast<int>(fixed->size()) == n) {
      joined.SetParameterBlockConstant(block);
    } else if (!fixed->empty()) {
      joined.SetManifold(block, new ceres::SubsetManifold(n, *fixed));
    }
    block += n;
  }
}

}  // namespace

Shooting shoot_with_ceres(const BoundaryValueProblem& problem,
                          const ShootingOptions& options,
                          Knots& knots) {
  const int n = knots.dof;
  const ShootingEquations equations(problem, knots, options);
  std::vector<Beginning> beginnings = begin(equations, knots);
  Shooting result;
  if (beginnings.empty()) return result;
  for (int i = 0; i < knots.segments; ++i) {
    const std::vector<double>& jacobian = beginnings[static_cast<std::size_t>(i)].jacobian;
    result.growth = std::max(result.growth, equations.growth(i, jacobian.data()));
  }
  if (result.growth > options.max_growth) return result;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Course course{options.tolerance, false, std::vector<double>(knots.segments, kInfinity)};
  ceres::Problem joined;
  for (int i = 0; i < knots.segments; ++i) {
    double* z = knots.at(i);
    auto* jump = new Jump(equations, i, std::move(beginnings[static_cast<std::size_t>(i)]), course);
    if (i + 1 == knots.segments) {
      joined.AddResidualBlock(jump, nullptr, z, z + n);
    } else {
      joined.AddResidualBlock(jump, nullptr, z, z + n, z + 2 * n, z + 3 * n);
    }
  }
  hold_start(problem, knots, joined);
  StopWhenJoined stop(options, course);
  ceres::Solver::Options solver = solver_options(problem, options);
  solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &joined, &summary);

  result.iterations = static_cast<int>(summary.iterations.size());
  result.residual = std::sqrt(2 * summary.final_cost);
  result.converged = summary.IsSolutionUsable() && result.residual <= options.tolerance;
  result.converged = equations.complete(knots) && result.converged;
  return result;
}

}  // namespace carnot::internal
