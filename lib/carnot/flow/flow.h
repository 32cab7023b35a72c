// The flow: many steps of one method, watched by an observer.
//
// Node times are t_i = t_0 + i h, never accumulated. The loop knows nothing of files, samples or
// progress: an observer is told of every step and may stop the run.
#pragma once

#include "carnot/flow/reports.h"
#include "carnot/system/phase_space.h"

namespace carnot {

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
