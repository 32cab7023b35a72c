#include "flow/flow_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "carnot/laws/step_choice.h"

namespace carnot::apps {
namespace {

// " (det H_yy = ...)" at (t, z), where H_y = 0 is solved by Newton's method; else nothing.
std::string regularity_text(const PointValues& at) {
  if (!at.regularity) return "";
  return fmt::format(" (det H_yy = {:.3g}, condition {:.3g})",
                     at.regularity->determinant,
                     at.regularity->condition);
}

PointValues values_at(const Dynamics& dynamics, double t, const std::vector<double>& z) {
  std::vector<double> q_dot(dynamics.dof);
  std::vector<double> lambda(dynamics.multipliers);
  const std::span at(z);
  return dynamics.evaluate(t, at.first(dynamics.dof), at.subspan(dynamics.dof), q_dot, lambda);
}

// Why a flow cannot start at z; empty when it can.
std::string start_failure(const FlowRequest& request) {
  const PointValues at = values_at(request.run.dynamics, request.start_time, request.z);
  if (at.status != RateStatus::kOk) {
    return std::string(describe(at.status)) + regularity_text(at);
  }
  return std::isfinite(at.hamiltonian) ? "" : "the Hamiltonian is not finite at the start";
}

// Fills request.plan's place in the outcome; false when there are no steps for the tolerance.
bool plan_steps(const FlowRequest& request, const Progress& progress, FlowOutcome& outcome) {
  if (request.plan) {
    outcome.plan = *request.plan;
    return true;
  }
  const StepChoice choice = choose_steps(request.run.dynamics,
                                         request.start_time,
                                         request.time,
                                         request.z,
                                         *request.tolerance,
                                         progress);
  outcome.message = choice.message;
  if (choice.status != StepChoiceStatus::kOk) return false;
  outcome.plan = StepPlan::equal(request.start_time, request.time, choice.count);
  outcome.plan.stop = choice.stop;
  return true;
}

void run_tangent(const FlowRequest& request, FlowOutcome& outcome, const Progress& progress) {
  outcome.tangent = tangent_along(request.run.dynamics, outcome.plan, request.z, progress);
  if (outcome.tangent->status == FlowStatus::kStepFailed) {
    outcome.message = "the tangent flow could not be formed";
  }
}

}  // namespace

FlowOutcome run_flow(const FlowRequest& request, const FlowWatch& watch) {
  const auto clock = [] { return std::chrono::steady_clock::now(); };
  const auto begin = clock();
  FlowOutcome outcome;
  outcome.z = request.z;
  outcome.summary.report.time_reached = request.start_time;
  outcome.summary.energy_drift = outcome.summary.constraint_error = std::nan("");  // no run yet
  outcome.message = start_failure(request);
  if (outcome.completed() && plan_steps(request, watch(0), outcome)) {
    const Progress progress = watch(outcome.plan.count);
    MonitorOptions audit;
    audit.samples = request.run.samples;
    audit.progress = progress;
    outcome.summary = request.run.dynamics.monitored_flow(outcome.plan, outcome.z, audit);
    outcome.message = outcome.summary.report.reason();
    if (!outcome.completed()) {
      const double reached = outcome.summary.report.time_reached;
      outcome.message += regularity_text(values_at(request.run.dynamics, reached, outcome.z));
    }
    const bool finite =
        std::all_of(outcome.z.begin(), outcome.z.end(), [](double x) { return std::isfinite(x); });
    if (outcome.completed() && !finite) outcome.message = "the end point is not finite";
    if (outcome.completed() && request.tangent) run_tangent(request, outcome, progress);
  }
  outcome.elapsed_seconds = std::chrono::duration<double>(clock() - begin).count();
  return outcome;
}

}  // namespace carnot::apps
