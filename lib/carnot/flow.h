// The flow: many steps of one method, watched by an observer.
//
// Node times are t_i = t_0 + i h, never accumulated. The loop knows nothing of files, samples or
// progress: an observer is told of every step and may stop the run.
#pragma once

#include <cmath>
#include <string_view>

#include "carnot/phase_space.h"

namespace carnot {

// Where the nodes are: `count` steps from `start`, all of length `step` but the last one, which has
// length `last` and ends at `end`. Negative steps run backwards.
struct StepPlan {
  double start = 0;
  double end = 0;
  double step = 0;
  double last = 0;
  long count = 0;
  double stop = 0;  // of the stage iteration, see RungeKutta::stop_at(); 0: round-off

  // `count` equal steps over `duration`.
  static StepPlan equal(double start, double duration, long count) {
    const double step = duration / static_cast<double>(count);
    return {start, start + duration, step, step, count};
  }

  // Steps of length h and, where h does not divide the duration, a shorter last one.
  static StepPlan of_length(double start, double duration, double h) {
    const double ratio = duration / h;
    const double nearest = std::round(ratio);
    constexpr double kRoundOff = 1e-12;  // a ratio this close to an integer is that integer
    if (nearest >= 1 && std::abs(ratio - nearest) <= kRoundOff * nearest) {
      return equal(start, duration, static_cast<long>(nearest));
    }
    const double whole = std::floor(ratio);
    return {start, start + duration, h, duration - whole * h, static_cast<long>(whole) + 1};
  }

  [[nodiscard]] double time(long i) const {
    return i == count ? end : start + static_cast<double>(i) * step;
  }
  [[nodiscard]] double length(long i) const { return i == count - 1 ? last : step; }
};

enum class FlowStatus { kCompleted, kStepFailed, kStopped };

// What a run did. On kStepFailed and kStopped the state is that of `time_reached`.
struct FlowReport {
  FlowStatus status = FlowStatus::kCompleted;
  StepReport last;
  double time_reached = 0;
  long steps = 0;
  long evaluations = 0;
  long newton_steps = 0;

  [[nodiscard]] bool completed() const { return status == FlowStatus::kCompleted; }

  [[nodiscard]] std::string_view reason() const {
    if (status == FlowStatus::kCompleted) return "";
    if (status == FlowStatus::kStopped) return "stopped by the caller";
    if (last.status == StepStatus::kRateFailed) return describe(last.rate);
    return "the stage equations did not converge: try a smaller step";
  }
};

template <class Stepper>
concept CanStopEarly = requires(Stepper& stepper) {
  stepper.stop_at(typename Stepper::Scalar(0));
};

// Advances z over the plan. `observe(i, stepper, z)` is called after step i (0-based), while the
// stepper still holds its stages; it returns false to stop. No allocation of its own.
template <class Stepper, class Observer>
FlowReport flow(Stepper& stepper,
                const StepPlan& plan,
                State<typename Stepper::Scalar, Stepper::kDof>& z,
                Observer&& observe) {
  using T = typename Stepper::Scalar;
  FlowReport report;
  report.time_reached = plan.start;
  if constexpr (CanStopEarly<Stepper>) stepper.stop_at(T(plan.stop));
  for (long i = 0; i < plan.count; ++i) {
    report.last = stepper.step(T(plan.time(i)), T(plan.length(i)), z);
    report.evaluations += report.last.evaluations;
    report.newton_steps += report.last.newton ? 1 : 0;
    if (report.last.status != StepStatus::kOk) {
      report.status = FlowStatus::kStepFailed;
      return report;
    }
    ++report.steps;
    report.time_reached = plan.time(i + 1);
    if (!observe(i, stepper, z)) {
      report.status = FlowStatus::kStopped;
      return report;
    }
  }
  return report;
}

template <class Stepper>
FlowReport flow(Stepper& stepper,
                const StepPlan& plan,
                State<typename Stepper::Scalar, Stepper::kDof>& z) {
  return flow(stepper, plan, z, [](long, const Stepper&, const auto&) { return true; });
}

}  // namespace carnot
