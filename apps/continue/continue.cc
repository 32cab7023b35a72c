// carnot continue: a geodesic followed while an end, the time or a parameter changes.
#include <CLI/CLI.hpp>
#include <memory>

#include "continue/continue_result.h"
#include "run/deferred.h"
#include "run/search_options.h"
#include "run/subcommands.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr const char* kContinueFooter = R"(
Follows one geodesic by pseudo-arclength from --from, --to, --time and --set, where s = 0, to the
value of --along, where s = 1: `to=Q1`, `from=Q0`, `time=T`, a parameter of the scene,
`limit:NAME=BOUND` (or A:B, both bounds) or `disc:K=X,Y,R` for the K-th --disc. Folds, where
the curve turns back, are passed; folds and branch points are listed. Every point is checked by an
independent integration, as in `carnot geodesic`, and labelled. "status" tells how the curve ended:
reached (s = 1), returned (to s = 0, after a fold), closed, max_points, step_too_small,
singular_start or not_converged. Where there are limits, s only goes up, and the places are listed
where arcs on limits come and go. --plot draws action and p(0) against what changes. Columns of a .csv
are branch, s, the value, action, length, errors, Morse index, label and p(0).

Examples
  carnot continue heisenberg-group --from 0,0,0 --to 0.5,0,0.5 --rank 2 --along to=0.5,0,0
  carnot continue vehicle --from 0,0,0,0 --to 2,1,0.5,0.5 --along alpha=0.1 --plot alpha.png
  carnot continue vehicle --from 0,0,0,0 --to 0,1,0,0 --limit 'phi-theta in -0.6:0.6' --along limit:phi-theta=0.2
  carnot continue vehicle-cosine --from 0,1,0,0 --to 0,-1,0,0 --along time=3 --json

Exit status: 0 followed to an end of the line, until it closed, or for --max-points; 1 it stopped
before or no geodesic was found to start with, 2 bad input, 130 interrupted.)";

ContinuationReport follow_with_bar(const ContinueRequest& request) {
  ProgressBar bar("%", 100, request.run.destination.quiet);
  return follow(request, bar.callback());
}

void add_continue_options(CLI::App& app, ContinueCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. -3,4,-pi/2,0");
  add("--to", options.to, "Q1", "configuration at the end");
  add("--time", options.time, "T", "how long it takes, > 0 (1)");
  add("--along",
      options.along,
      "NAME=VALUE",
      "what changes: to, from, time, a parameter, limit:NAME or disc:K");
  add("--rank", options.rank, "N", "start from the extremal of N-th least action (1)");
  add("--guess",
      options.guess,
      "P0",
      "momentum to start from instead; with limits, of the one to start from");
  add("--time-limit", options.time_limit, "SECONDS", "of the search for the start (none)");
  add("--max-points", options.max_points, "N", "stop after so many (1000)");
  add("--tolerance",
      options.tolerance,
      "TOL",
      "largest error at the end (1e-10 of the problem's own scales)");
  add_limit_options(app, options.asked);
  app.add_flag("--branches", options.branches, "follow the curves that cross at branch points");
  app.add_flag("--no-labels", options.no_labels, "leave out Morse index and label: faster");
}

}  // namespace

void add_continue(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<ContinueCall>();
  CLI::App& subcommand = add_deferred_command(app, "continue");
  add_continue_options(subcommand, *options);
  add_model_options(subcommand, options->run);
  add_effort_options(subcommand, options->run);
  add_result_options(subcommand, options->run.destination);
  subcommand.footer(kContinueFooter);
  subcommand.callback([options, &invocation] {
    const ContinueRequest request = check(*options);
    const ContinuationReport report = follow_with_bar(request);
    invocation.exit_status = report.status == ContinuationStatus::kInterrupted
                                 ? kInterrupted
                                 : deliver(continue_result(request, report, invocation.arguments),
                                           request.run.destination);
  });
}

}  // namespace carnot::apps
