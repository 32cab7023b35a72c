#include "carnot/shooting/shoot/shooting_equations.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {

ShootingEquations::ShootingEquations(const BoundaryValueProblem& problem,
                                     const Knots& knots,
                                     const ShootingOptions& options)
    : problem_(problem),
      segments_(knots.segments),
      dof_(knots.dof),
      steps_(options.steps),
      stop_(options.stop) {
  constexpr double kLeast = 0.01;  // of the largest momentum
  double q_scale = distance_between_ends(problem);
  std::vector<double> own(dof_, 0.0);
  for (int i = 0; i <= segments_; ++i) {
    for (int j = 0; j < dof_; ++j) {
      q_scale = std::max(q_scale, std::abs(knots.at(i)[j] - knots.at(0)[j]));
      own[j] = std::max(own[j], std::abs(knots.at(i)[dof_ + j]));
    }
  }
  double p_scale = *std::max_element(own.begin(), own.end());
  // Where nothing moves any unit will do.
  if (q_scale < kRestRoundOff) q_scale = 1;
  if (p_scale < kRestRoundOff) p_scale = 1;
  scale_.assign(dof_, q_scale);
  for (const double p : own) {
    scale_.push_back(options.own_scales ? std::max(p, kLeast * p_scale) : p_scale);
  }
}

bool ShootingEquations::evaluate(
    int i, const double* z, const double* next, double* residual, double* jacobian) const {
  if (stopped()) return false;
  const bool last = i + 1 == segments_;
  const int size = 2 * dof_;
  const StepPlan plan = knot_plan(problem_, segments_, i, steps_);
  std::vector<double> end(z, z + size);
  std::vector<double> tangent(jacobian != nullptr ? size * size : 0);
  const FlowReport report = jacobian != nullptr ? problem_.dynamics.tangent_flow(plan, end, tangent)
                                                : problem_.dynamics.flow(plan, end);
  if (!report.completed()) return false;
  for (int row = 0; row < residuals(i); ++row) {
    const int at = component(i, row);
    const double wanted = last ? target_value(problem_, row) : next[row];
    residual[row] = (end[at] - wanted) / scale_[at];
    if (!std::isfinite(residual[row])) return false;
    for (int j = 0; jacobian != nullptr && j < size; ++j) {
      jacobian[row * size + j] = tangent[at * size + j] / scale_[at];
      if (!std::isfinite(jacobian[row * size + j])) return false;
    }
  }
  return true;
}

double ShootingEquations::growth(int i, const double* jacobian) const {
  double growth = 0;
  for (int c = i == 0 ? dof_ : 0; c < 2 * dof_; ++c) {
    const int at = place((2 * i - 1) * dof_ + c) % (2 * dof_);
    for (int r = 0; r < residuals(i); ++r) {
      growth = std::max(growth, std::abs(jacobian[r * 2 * dof_ + at] * scale_[at]));
    }
  }
  return growth;
}

bool ShootingEquations::complete(Knots& knots) const {
  const int last = segments_ - 1;
  std::copy(knots.at(last), knots.at(last) + 2 * dof_, knots.at(segments_));
  const std::span z(knots.at(segments_), 2 * dof_);
  return problem_.dynamics.flow(knot_plan(problem_, segments_, last, steps_), z).completed();
}

}  // namespace carnot::internal
