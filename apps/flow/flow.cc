// carnot flow: an initial value problem, advanced and measured.
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "flow/flow_run.h"
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
    std::optional<ProgressBar> bar;
    const FlowOutcome outcome = run_flow(request, [&](long steps) -> Progress {
      if (steps == 0) return [](double /*fraction*/) { return !interrupted(); };
      bar.emplace("steps", static_cast<double>(steps), request.run.destination.quiet);
      return bar->callback();
    });
    bar.reset();
    invocation.exit_status =
        deliver(flow_result(request, outcome, invocation.arguments), request.run.destination);
  });
}

}  // namespace carnot::apps
