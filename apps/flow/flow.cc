// carnot flow: an initial value problem, advanced and measured.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>

#include "carnot/laws/step_choice.h"
#include "flow/flow_request.h"
#include "flow/flow_result.h"
#include "run/subcommands.h"
#include "text/interrupt.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr const char* kFlowFooter = R"(
Exactly one of --momentum and --velocity, exactly one of --step, --steps and --tolerance.
p = dL/dq' - G' lambda. --velocity must satisfy the constraints to 1e-9 relative; it is then
projected, and p follows with lambda = 0 or that of --lambda. Angles are radians; pi/2 and -3*pi/4
are numbers. Units are the scene's own: see `carnot scenes SCENE`.
Where constraints are not linear in q', one p can have several lambda: --lambda picks the branch.
--tolerance chooses equal steps by a cheap trial (gauss16), or runs until N and 2N steps agree; "evaluations" counts the final run only.
"symplecticity_defect_relative" divides by max(1, |M|^2) with the Frobenius norm of M.

Examples
  carnot flow vehicle --from 0,0,0,0 --momentum 1,0,0,0.3 --time 5 --steps 100
  carnot flow heisenberg --from 0,0,0 --velocity 1,0,0 --time 2*pi --tolerance 1e-12 --json
  carnot flow unicycle --from -1,0,-pi/2 --momentum 1,2,0 --time 3 --step 0.1 --tangent --json

Exit status: 0 completed, 1 a step failed or the tolerance is out of reach, 2 bad input,
130 interrupted.)";

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
bool plan_steps(const FlowRequest& request, FlowOutcome& outcome) {
  if (request.plan) {
    outcome.plan = *request.plan;
    return true;
  }
  const StepChoice choice = choose_steps(request.run.dynamics,
                                         request.start_time,
                                         request.time,
                                         request.z,
                                         *request.tolerance,
                                         [](double /*fraction*/) { return !interrupted(); });
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

FlowOutcome run_flow(const FlowRequest& request) {
  const auto clock = [] { return std::chrono::steady_clock::now(); };
  const auto begin = clock();
  FlowOutcome outcome;
  outcome.z = request.z;
  outcome.summary.report.time_reached = request.start_time;
  outcome.summary.energy_drift = outcome.summary.constraint_error = std::nan("");  // no run yet
  outcome.message = start_failure(request);
  if (outcome.completed() && plan_steps(request, outcome)) {
    ProgressBar bar(
        "steps", static_cast<double>(outcome.plan.count), request.run.destination.quiet);
    MonitorOptions audit;
    audit.samples = request.run.samples;
    audit.progress = bar.callback();
    outcome.summary = request.run.dynamics.monitored_flow(outcome.plan, outcome.z, audit);
    outcome.message = outcome.summary.report.reason();
    if (!outcome.completed()) {
      const double reached = outcome.summary.report.time_reached;
      outcome.message += regularity_text(values_at(request.run.dynamics, reached, outcome.z));
    }
    const bool finite =
        std::all_of(outcome.z.begin(), outcome.z.end(), [](double x) { return std::isfinite(x); });
    if (outcome.completed() && !finite) outcome.message = "the end point is not finite";
    if (outcome.completed() && request.tangent) run_tangent(request, outcome, bar.callback());
  }
  outcome.elapsed_seconds = std::chrono::duration<double>(clock() - begin).count();
  return outcome;
}

}  // namespace

void add_flow(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<FlowOptions>();
  CLI::App& flow = *app.add_subcommand("flow", "Advance a scene from given initial data.");
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    flow.add_option(name, value, help)->type_name(type);
  };
  add("--from", options->from, "Q0", "configuration at the start, e.g. -3,4,-pi/2,0");
  add("--momentum", options->momentum, "P0", "momentum at the start");
  add("--velocity", options->velocity, "V0", "velocity at the start, instead of --momentum");
  add("--lambda",
      options->lambda,
      "L0",
      "multipliers that go with --velocity (0), or that pick the branch");
  add("--time", options->time, "T", "how long, > 0");
  add("--step", options->step, "H", "length of a step; the last one may be shorter");
  add("--steps", options->steps, "N", "number of equal steps");
  add("--tolerance", options->tolerance, "TOL", "choose the steps for this error at the end");
  add("--stage-tolerance",
      options->stage_tolerance,
      "TOL",
      "end the iteration for the stages at changes below this, not at round-off");
  add("--start-time", options->start_time, "T0", "time at the start (0)");
  flow.add_flag("--tangent", options->tangent, "also d(q,p)(T)/d(q,p)(0)");
  add_run_options(flow, options->run);
  flow.footer(kFlowFooter);
  flow.callback([options, &invocation] {
    const FlowRequest request = check(*options);
    const FlowOutcome outcome = run_flow(request);
    invocation.exit_status =
        deliver(flow_result(request, outcome, invocation.arguments), request.run.destination);
  });
}

}  // namespace carnot::apps
