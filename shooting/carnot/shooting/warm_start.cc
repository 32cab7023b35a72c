#include "carnot/shooting/warm_start.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "carnot/shooting/end_point.h"

namespace carnot {
namespace {

constexpr long kSteps = 64;  // of the tangent flow, and where there is no choice of steps

// The steps that reach the tolerance along the extremal from z.
StepPlan plan_for(const BoundaryValueProblem& problem, std::vector<double> z, double tolerance) {
  if (problem.segment.has_automatic_flow()) {
    const AutomaticFlow flow = problem.segment.automatic_flow(0, problem.time, tolerance, z.data());
    if (flow.reached) return flow.plan;
  }
  return StepPlan::equal(0, problem.time, kSteps);
}

// Broyden's update of an inverse Jacobian, such that inverse * change = step.
template <class Vector, class Matrix>
void update(const Vector& step, const Vector& change, Matrix& inverse) {
  const Vector image = inverse.lazyProduct(change);
  const double weight = step.dot(image);
  if (weight == 0) return;
  const Vector row = inverse.transpose().lazyProduct(step);
  inverse += ((step - image) / weight).lazyProduct(row.transpose());
}

}  // namespace

WarmStart::WarmStart(const BoundaryValueProblem& problem,
                     const std::vector<double>& p0,
                     double tolerance)
    : problem_(problem), tolerance_(tolerance) {
  problem.validate();
  const int n = problem.segment.dof;
  if (static_cast<int>(p0.size()) != n || n > kMostDof) {
    throw std::invalid_argument("p0 has " + std::to_string(p0.size()) +
                                " components, the scene has " + std::to_string(n) + ", at most " +
                                std::to_string(kMostDof));
  }
  if (!(tolerance > 0 && std::isfinite(tolerance))) {
    throw std::invalid_argument("tolerance is " + std::to_string(tolerance) + ", must be > 0");
  }
  constexpr double kFine = 0.1;
  constexpr double kStricter = 0.01;
  constexpr double kArrives = 1e-6;
  p0_ = Eigen::Map<const Eigen::VectorXd>(p0.data(), n);
  if (!differentiate()) return;
  std::vector<double> start = problem.from;
  start.insert(start.end(), p0.begin(), p0.end());
  plan_ = plan_for(problem, start, kFine * tolerance);
  check_ = StepPlan::equal(0, problem.time, 2 * plan_.count);
  check_.stop = kStricter * plan_.stop;
  ready_ =
      end_of(plan_, p0_, end_) && largest_difference(end_.data(), problem.to.data(), n) <= kArrives;
}

bool WarmStart::differentiate() {
  constexpr double kSingular = 1e-11;
  constexpr double kAside = 1e-4;  // of p0, for differences
  const auto tangent_at = [&](Eigen::Index j, double aside) {
    std::vector<double> p0(p0_.data(), p0_.data() + p0_.size());
    p0[j] += aside;
    std::vector<double> z;
    return end_point_tangent(problem_, p0, problem_.time, kSteps, z);
  };
  const auto tangent = tangent_at(0, 0);
  if (!tangent) return false;
  jacobian_ = tangent->topRows(p0_.size());
  Eigen::FullPivLU<SmallMatrix> lu(jacobian_);
  lu.setThreshold(kSingular);
  if (!lu.isInvertible()) return false;
  inverse_ = lu.inverse();
  const double aside = kAside * p0_.cwiseAbs().maxCoeff();
  for (Eigen::Index j = 0; j < p0_.size(); ++j) {
    const auto after = tangent_at(j, aside);
    const auto before = tangent_at(j, -aside);
    if (!after || !before) return false;
    bend_.emplace_back((after->topRows(p0_.size()) - before->topRows(p0_.size())) / (2 * aside));
  }
  return true;
}

void WarmStart::predict(const Small& change_of_end, Small& change, SmallMatrix& inverse) const {
  constexpr int kMostIterations = 8;
  constexpr double kClose = 1e-3;  // of the change: the model is no better
  change = inverse_.lazyProduct(change_of_end);
  inverse = inverse_;
  Small trial = change;
  for (int i = 0; i < kMostIterations; ++i) {
    // q(T) changes by (J + B/2) change with B = sum_j change_j dJ/dp_j; its derivative is J + B.
    SmallMatrix bend = SmallMatrix::Zero(trial.size(), trial.size());
    for (Eigen::Index j = 0; j < trial.size(); ++j) bend += trial[j] * bend_[j];
    const SmallMatrix middle = jacobian_ + 0.5 * bend;
    const Eigen::PartialPivLU<SmallMatrix> lu(jacobian_ + bend);
    const Small step = lu.solve(middle.lazyProduct(trial) - change_of_end);
    if (!(step.norm() <= trial.norm())) return;
    trial -= step;
    if (step.norm() > kClose * trial.norm()) continue;
    change = trial;
    inverse = lu.inverse();
    return;
  }
}

bool WarmStart::end_of(const StepPlan& plan, const Small& p0, Small& q) const {
  const int n = problem_.segment.dof;
  std::array<double, 2 * kMostDof> z{};
  std::copy(problem_.from.begin(), problem_.from.end(), z.begin());
  std::copy(p0.data(), p0.data() + n, z.begin() + n);
  if (!problem_.segment.flow(plan, z.data()).completed()) return false;
  q = Eigen::Map<const Small>(z.data(), n);
  return q.allFinite();
}

WarmStartReport WarmStart::solve(const double* to, double* p0) const {
  constexpr int kMostFlows = 12;
  constexpr double kAim = 0.3;  // of the tolerance
  constexpr double kGrows = 2;
  const int n = problem_.segment.dof;
  std::copy(p0_.data(), p0_.data() + n, p0);
  WarmStartReport report;
  if (!ready_) return report;
  const Eigen::Map<const Small> target(to, n);
  Small p = p0_;
  Small end;
  Small residual = end_ - target;
  Small step;
  SmallMatrix inverse;
  predict(-residual, step, inverse);
  double size = residual.cwiseAbs().maxCoeff();
  const double largest = std::max(kGrows * size, tolerance_);
  double expected = size;  // after the next step
  while (report.flows < kMostFlows) {
    const bool arrived = size <= kAim * tolerance_;
    const bool last = arrived || expected <= kAim * tolerance_;
    if (report.flows > 0) step = -inverse.lazyProduct(residual);
    if (arrived) step.setZero();
    p += step;
    ++report.flows;
    if (!end_of(last ? check_ : plan_, p, end)) return report;
    const Small change = end - target - residual;
    residual = end - target;
    const double now = residual.cwiseAbs().maxCoeff();
    if (last) report.endpoint_error = now;
    report.converged = last && now <= tolerance_;
    if (report.converged || !(now <= largest)) break;
    // The model's Jacobian is that of the end of its step.
    if (report.flows > 1 && !arrived) update(step, change, inverse);
    expected = std::min(now, now * now / size);
    size = now;
  }
  if (report.converged) std::copy(p.data(), p.data() + n, p0);
  return report;
}

}  // namespace carnot
