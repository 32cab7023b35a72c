#include "carnot/shooting/warm_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/problem/rescaled.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/steer/end_point_model.h"

namespace carnot {

using namespace internal;

namespace {

// The largest change at which stages have settled for such a tolerance in the scales, in units of
// the scene; 0, which is round-off, where its numbers are too unlike for one such change.
double stop_for(const NaturalScales& scales, const std::vector<double>& z, double tolerance) {
  constexpr double kStop = 3;  // of the tolerance: what is left is smaller by the contraction
  constexpr double kRoundOff = 100 * std::numeric_limits<double>::epsilon();
  const auto n = static_cast<int>(scales.q.size());
  double least = std::numeric_limits<double>::infinity();
  double largest = 0;
  for (int j = 0; j < n; ++j) {
    least = std::min({least, scales.q[j], scales.momentum(j)});
    largest = std::max({largest,
                        scales.q[j] * std::max(1.0, std::abs(z[j])),
                        scales.momentum(j) * std::max(1.0, std::abs(z[n + j]))});
  }
  const double stop = kStop * tolerance * least;
  return stop >= kRoundOff * largest ? stop : 0;
}

// The equal steps that reach the tolerance along the extremal from z, all in the scales: twice as
// many until an error is small enough, and then as many as the order says. Where none reach it, as
// many as the model has.
StepPlan plan_for(const BoundaryValueProblem& problem,
                  const NaturalScales& scales,
                  const std::vector<double>& z,
                  double tolerance) {
  constexpr long kFewest = 16;
  constexpr long kMost = 4096;
  constexpr double kSafety = 1.1;
  const auto with = [&](long count) {
    StepPlan plan = StepPlan::equal(0, problem.time, count);
    plan.stop = stop_for(scales, z, tolerance);
    return plan;
  };
  std::vector<double> coarse;
  for (long count = kFewest; count <= kMost; count *= 2) {
    std::vector<double> fine = z;
    if (!problem.dynamics.flow(with(count), fine).completed()) continue;
    if (!coarse.empty()) {
      const double error =
          largest_difference(coarse.data(), fine.data(), static_cast<int>(z.size()));
      if (error <= tolerance) {
        const double part = std::pow(error / tolerance, 1.0 / problem.dynamics.order);
        return with(
            std::lround(std::ceil(std::min(1.0, kSafety * part) * static_cast<double>(count) / 2)));
      }
    }
    coarse = std::move(fine);
  }
  return StepPlan::equal(0, problem.time, EndPointModel::kSteps);
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

// Throws unless the arguments of the constructor are what it asks for.
void check(const BoundaryValueProblem& problem, const std::vector<double>& p0, double tolerance) {
  constexpr int kMost = EndPointModel::kMostDof;
  problem.validate();
  if (!problem.limits.empty()) {
    throw std::invalid_argument(
        "a warm start does not keep to limits: take them out of the problem");
  }
  const int n = problem.dynamics.dof;
  if (static_cast<int>(p0.size()) != n || n > kMost) {
    throw std::invalid_argument("p0 has " + std::to_string(p0.size()) +
                                " components, the scene has " + std::to_string(n) + ", at most " +
                                std::to_string(kMost));
  }
  if (!(tolerance > 0 && std::isfinite(tolerance))) {
    throw std::invalid_argument("tolerance is " + std::to_string(tolerance) + ", must be > 0");
  }
}

EndPointModel::Vector units_of_start(const BoundaryValueProblem& problem,
                                     const NaturalScales& scales) {
  EndPointModel::Vector units(problem.dynamics.dof);
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    units[j] = problem.is_free_from(j) ? scales.q[j] : scales.momentum(j);
  }
  return units;
}

}  // namespace

class WarmStart::Implementation {
 public:
  Implementation(const BoundaryValueProblem& problem,
                 const std::vector<double>& p0,
                 double tolerance);

  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] WarmStartReport solve(const double* to, double* p0) const;

 private:
  using Vector = EndPointModel::Vector;

  // q(T) from the unknowns of the start, p_j(T) in the place of what is free. False when the flow
  // fails.
  [[nodiscard]] bool end_of(const StepPlan& plan, const Vector& p0, Vector& q) const;

  // What is asked for at `to`: zero for the momenta of free coordinates.
  [[nodiscard]] Vector target_of(const double* to) const {
    Vector target(problem_.dynamics.dof);
    for (int j = 0; j < problem_.dynamics.dof; ++j) {
      target[j] = problem_.is_free_to(j) ? 0 : to[j] / scales_.q[j];
    }
    return target;
  }

  NaturalScales scales_;
  BoundaryValueProblem problem_;  // in these scales, as all below
  Vector units_;                  // of the unknowns of the start
  double tolerance_;
  double roughness_;           // the error of rough flows
  std::vector<double> known_;  // the momentum as it was given
  Vector p0_;
  EndPointModel model_;
  bool ready_ = false;
  Vector end_;      // q(T) from p0_
  StepPlan rough_;  // of the first flows,
  StepPlan plan_;   // of those near the target,
  StepPlan check_;  // and of the last
};

WarmStart::Implementation::Implementation(const BoundaryValueProblem& problem,
                                          const std::vector<double>& p0,
                                          double tolerance)
    : scales_((check(problem, p0, tolerance), natural_scales(problem))),
      problem_(scales_.trivial() ? problem : rescaled(problem, scales_)),
      units_(units_of_start(problem, scales_)),
      tolerance_(tolerance),
      roughness_(0.1 * std::sqrt(tolerance)),
      known_(p0),
      p0_(Eigen::Map<const Vector>(p0.data(), problem.dynamics.dof).cwiseQuotient(units_)),
      model_(problem_, p0_) {
  constexpr double kFine = 0.1;
  constexpr double kStricter = 0.01;  // the error of the check over that of the others
  constexpr double kArrives = 1e-6;
  if (!model_.invertible()) return;
  const std::vector<double> start = phase_point(problem_, {p0_.data(), p0_.data() + p0_.size()});
  rough_ = plan_for(problem_, scales_, start, roughness_);
  plan_ = plan_for(problem_, scales_, start, kFine * tolerance);
  const double shorter = std::pow(kStricter, -1.0 / problem.dynamics.order);
  check_ = StepPlan::equal(
      0, problem_.time, std::lround(std::ceil(shorter * static_cast<double>(plan_.count))));
  check_.stop = kStricter * plan_.stop;
  ready_ = end_of(plan_, p0_, end_) &&
           (end_ - target_of(problem.to.data())).cwiseAbs().maxCoeff() <= kArrives;
}

bool WarmStart::Implementation::end_of(const StepPlan& plan, const Vector& p0, Vector& q) const {
  const int n = problem_.dynamics.dof;
  std::array<double, 2 * EndPointModel::kMostDof> z{};
  std::copy(problem_.from.begin(), problem_.from.end(), z.begin());
  for (int j = 0; j < n; ++j) z[start_index(problem_, j)] = p0[j];
  if (!problem_.dynamics.flow(plan, std::span(z).first(2 * n)).completed()) return false;
  q.resize(n);
  for (int j = 0; j < n; ++j) q[j] = z[target_index(problem_, j)];
  return q.allFinite();
}

WarmStartReport WarmStart::Implementation::solve(const double* to, double* p0) const {
  constexpr int kMostFlows = 16;
  constexpr double kAim = 0.3;  // of the tolerance
  constexpr double kFar = 30;   // times the roughness: a rough flow is good enough
  const int n = problem_.dynamics.dof;
  std::copy(known_.begin(), known_.end(), p0);
  WarmStartReport report;
  if (!ready_) return report;
  const Vector target = target_of(to);
  Vector p = p0_;
  Vector residual = end_ - target;
  double error = residual.cwiseAbs().maxCoeff();
  auto [step, inverse, expected] = model_.move_end(-residual);
  Vector end = end_;
  while (report.flows < kMostFlows) {
    const bool arrived = error <= kAim * tolerance_;
    const bool last = arrived || expected <= kAim * tolerance_;
    const bool rough = expected > kFar * roughness_;
    if (arrived) step.setZero();
    ++report.flows;
    if (!end_of(last ? check_ : rough ? rough_ : plan_, p + step, end)) {
      step /= 2;
      continue;
    }
    const Vector now = end - target;
    const double size = now.cwiseAbs().maxCoeff();
    if (last) report.endpoint_error = size;
    report.converged = last && size <= tolerance_;
    // The first step needs no update: the model's Jacobian is that at the end of its step.
    if (report.flows > 1 && !arrived) update(step, Vector(now - residual), inverse);
    if (size > error && !arrived && !report.converged) {
      step /= 2;
      continue;
    }
    p += step;
    if (report.converged) break;
    residual = now;
    step = -inverse.lazyProduct(residual);
    const double resolved = rough ? roughness_ : 0;
    expected = std::max(resolved, std::min(size, size * size / error));
    error = std::max(resolved, size);
  }
  for (int j = 0; report.converged && j < n; ++j) p0[j] = p[j] * units_[j];
  return report;
}

WarmStart::WarmStart(const BoundaryValueProblem& problem,
                     const std::vector<double>& p0,
                     double tolerance)
    : own_(std::make_shared<const Implementation>(problem, p0, tolerance)) {}

bool WarmStart::ready() const { return own_->ready(); }

WarmStartReport WarmStart::solve(const double* to, double* p0) const { return own_->solve(to, p0); }

}  // namespace carnot
