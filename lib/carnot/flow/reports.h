// What a run is asked for and what it answers, in plain numbers: plans of steps, reports, records.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "carnot/step/step_report.h"

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

struct BatchReport {
  long completed = 0;
  long failed = 0;       // their z are NaN
  long evaluations = 0;  // rate() calls, each lane of a pack counted
};

struct AutomaticFlow {
  bool reached = false;  // else z is unchanged: the trial failed, or the tolerance is out of reach
  StepPlan plan;         // of the run that made z
  FlowReport report;     // of that run
  double error = 0;      // estimated, max-norm of (q, p) at the end
  long evaluations = 0;  // of all runs and the trial
};

// One row per time; q, p of length n, lambda of length k.
struct Trajectory {
  std::vector<double> t;
  std::vector<std::vector<double>> q;
  std::vector<std::vector<double>> p;
  std::vector<std::vector<double>> lambda;
  std::vector<double> hamiltonian;
  // The integral of H_t from the first time on, by which H of the exact solution changes; 0 where H
  // does not depend on time. Empty where it was not measured.
  std::vector<double> work;
};

// `samples` equidistant times of the plan, ends included.
inline std::vector<double> sample_times(const StepPlan& plan, long samples) {
  std::vector<double> times;
  for (long i = 0; i + 1 < samples; ++i) {
    const double fraction = static_cast<double>(i) / static_cast<double>(samples - 1);
    times.push_back(plan.start + fraction * (plan.end - plan.start));
  }
  if (samples > 0) times.push_back(plan.end);
  return times;
}

// What a run of a Dynamics measured. All but `report` only from monitored_flow(); see monitor.h.
struct FlowSummary {
  FlowReport report;
  double action = 0;
  double length = 0;  // NaN where the scene has no metric
  double work = 0;    // the integral of H_t
  double energy_drift = 0;
  double energy_balance = 0;
  double constraint_error = 0;
  double holonomic_error = 0;
  Trajectory trajectory;

  [[nodiscard]] bool completed() const { return report.completed(); }
};

// Told the fraction done every now and then; returns false to stop.
using Progress = std::function<bool(double fraction)>;

struct MonitorOptions {
  long samples = 0;           // equidistant times recorded in `trajectory`
  std::vector<double> times;  // recorded instead, where given; ascending, within the plan
  Progress progress;
};

}  // namespace carnot
