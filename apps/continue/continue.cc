// carnot continue: a geodesic followed while an end, the time or a parameter changes.
#include <fmt/format.h>

#include <memory>

#include "carnot/shooting/find_geodesics.h"
#include "catalogue/scene_choice.h"
#include "continue/continue_result.h"
#include "run/subcommands.h"
#include "text/numbers.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr long kMostPoints = 1000000;
constexpr long kMostRank = 10000;
constexpr long kSamples = 129;  // of the start, for its knots

constexpr const char* kContinueFooter = R"(
Follows one geodesic by pseudo-arclength from --from, --to, --time and --set, where s = 0, to the
value of --along, where s = 1: `to=Q1`, `from=Q0`, `time=T` or a parameter of the scene. Folds, where
the curve turns back, are passed; folds and branch points are listed. Every point is checked by an
independent integration, as in `carnot geodesic`, and labelled. "status" tells how the curve ended:
reached (s = 1), returned (to s = 0, after a fold), closed, max_points, step_too_small,
singular_start or not_converged. --plot draws action and p(0) against what changes. Columns of a .csv
are branch, s, the value, action, length, errors, Morse index, label and p(0).

Examples
  carnot continue heisenberg-group --from 0,0,0 --to 0.5,0,0.5 --rank 2 --along to=0.5,0,0
  carnot continue vehicle --from 0,0,0,0 --to 2,1,0.5,0.5 --along alpha=0.1 --plot alpha.png
  carnot continue vehicle-cosine --from 0,1,0,0 --to 0,-1,0,0 --along time=3 --json

Exit status: 0 followed to an end of the line, until it closed, or for --max-points; 1 it stopped
before or no geodesic was found to start with, 2 bad input, 130 interrupted.)";

struct ContinueCall {
  RunOptions run;
  std::string from;
  std::string to;
  std::string time = "1";
  std::string along;
  std::string rank;
  std::string guess;
  std::string max_points = "1000";
  std::string tolerance = "1e-10";
  std::string time_limit;
  bool branches = false;
  bool no_labels = false;
};

ContinueRequest check(const ContinueCall& options) {
  ContinueRequest request;
  request.run = check(options.run);
  const SceneEntry& entry = *request.run.entry;
  const auto names = coordinate_names(entry);
  if (options.along.empty()) refuse_missing("--along", "to=Q1, from=Q0, time=T or PARAMETER=VALUE");
  if (request.run.dynamics.forced > 0) {
    refuse("SCENE",
           entry.info.name,
           "continuation is not offered with holonomic constraints that need RATTLE",
           "a scene without them");
  }
  if (!request.run.dynamics.info.limits.empty()) {
    refuse(
        "SCENE", entry.info.name, "continuation does not keep to limits", "a scene without them");
  }
  request.ends = parse_ends(options.from, options.to, options.time, request.run);
  request.along = parse_along(options.along, request.run, request.ends);
  if (!options.guess.empty() && !options.rank.empty()) {
    refuse("--rank", options.rank, "given besides --guess", "one of the two");
  }
  if (!options.guess.empty()) request.guess = parse_vector("--guess", options.guess, names);
  if (!options.rank.empty()) {
    request.rank = static_cast<int>(parse_integer("--rank", options.rank, 1, kMostRank));
  }
  request.options.max_points =
      static_cast<int>(parse_integer("--max-points", options.max_points, 1, kMostPoints));
  request.options.tolerance = parse_tolerance("--tolerance", options.tolerance);
  if (!options.time_limit.empty()) {
    request.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  request.options.branches = options.branches;
  request.options.labels = !options.no_labels;
  return request;
}

// The geodesic to start from, then the curve.
ContinuationReport run(const ContinueRequest& request) {
  ProgressBar bar("%", 100, request.run.destination.quiet);
  const Progress progress = bar.callback();
  GeodesicOptions search;
  search.count = request.rank;
  search.guess = request.guess;
  search.absolute_tolerance = request.options.tolerance;
  search.time_limit = request.time_limit;
  search.seed = request.run.seed;
  search.threads = request.run.threads;
  search.samples = kSamples;
  search.progress = [&](double /*fraction*/) { return progress(0); };
  const ProblemLine line = line_of(request.along, request.run, request.ends);
  const GeodesicReport found = find_geodesics(line.at(0), search);
  ContinuationReport report;
  const auto rank = static_cast<std::size_t>(request.rank);
  if (found.status == GeodesicStatus::kInterrupted) {
    report.status = ContinuationStatus::kInterrupted;
  } else if (found.geodesics.size() < rank) {
    report.message = "no geodesic was found to start with: " + found.message;
    if (!found.geodesics.empty()) {
      report.message =
          fmt::format("only {} geodesics were found at the start: try a --rank up to that",
                      found.geodesics.size());
    }
  } else {
    ContinuationOptions options = request.options;
    options.progress = progress;
    report = continue_geodesic(line, found.geodesics[rank - 1], options);
  }
  return report;
}

void add_continue_options(CLI::App& app, ContinueCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. -3,4,-pi/2,0");
  add("--to", options.to, "Q1", "configuration at the end");
  add("--time", options.time, "T", "how long it takes, > 0 (1)");
  add("--along", options.along, "NAME=VALUE", "what changes: to, from, time or a parameter");
  add("--rank", options.rank, "N", "start from the extremal of N-th least action (1)");
  add("--guess", options.guess, "P0", "momentum to start from instead");
  add("--time-limit", options.time_limit, "SECONDS", "of the search for the start (none)");
  add("--max-points", options.max_points, "N", "stop after so many (1000)");
  add("--tolerance", options.tolerance, "TOL", "largest error at the end (1e-10)");
  app.add_flag("--branches", options.branches, "follow the curves that cross at branch points");
  app.add_flag("--no-labels", options.no_labels, "leave out Morse index and label: faster");
}

}  // namespace

void add_continue(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<ContinueCall>();
  CLI::App& subcommand = *app.add_subcommand(
      "continue", "Follow a geodesic while an end, the time or a parameter changes.");
  add_continue_options(subcommand, *options);
  add_model_options(subcommand, options->run);
  add_effort_options(subcommand, options->run);
  add_result_options(subcommand, options->run.destination);
  subcommand.footer(kContinueFooter);
  subcommand.callback([options, &invocation] {
    const ContinueRequest request = check(*options);
    const ContinuationReport report = run(request);
    invocation.exit_status = report.status == ContinuationStatus::kInterrupted
                                 ? kInterrupted
                                 : deliver(continue_result(request, report, invocation.arguments),
                                           request.run.destination);
  });
}

}  // namespace carnot::apps
