// carnot geodesic: extremals that join two configurations, without a guess.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "carnot/language/nearest.h"
#include "catalogue/limit_choice.h"
#include "catalogue/scene_choice.h"
#include "geodesic/geodesic_result.h"
#include "run/subcommands.h"
#include "text/numbers.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr long kMostGeodesics = 10000;
constexpr long kMostStarts = 10000000;

constexpr const char* kGeodesicFooter = R"(
No guess is needed. Distinct extremals are listed, least action first; mirror partners count
separately. Angles live on the cover: 0 and 2 pi are different ends, unless --mod-angles. Every
extremal is checked by an independent integration at a tighter setting: its largest error at the end
is "error" in the table and "endpoint_error" in the JSON. There, "hits" counts the starts that led to
an extremal or a mirror partner, and "missed_estimate" is Chao's estimate of how many were not
found, or null where starts say too little.
On failure "reason" is a code, in the order of how far the best attempt came:
no-start-converged, singular-coordinates (most paths ran into one), guess-failed, not-refined,
flow-failed, not-joined, not-verified, beyond-double (round-off exceeds the tolerance), too-long (for
--max-length); "message" says more and what to try.
A coordinate of an end that is * is free: its momentum vanishes there. What was found is
"from_found" and "to_found" in the JSON, the largest such momentum "transversality_error".
With limits, "limits" in the JSON has the closest approach to each ("lowest_slack"), when the path
keeps to it and its largest multiplier. "verification" is then "knots", or "grid" where only the path
on the finest grid is known; "grid_error" says by how much its action may be wrong. Reasons are
limit-at-end and limits-infeasible, too.
Angles are radians; pi/2 and -3*pi/4 are numbers. Units are the scene's own: see
`carnot scenes SCENE`.

Examples
  carnot geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --plot parking.png
  carnot geodesic vehicle --from -3,4,-pi/2,0 --to 0,0,0,0 --count 4 --json
  carnot geodesic vehicle --from 0,0,0,0 --to '0,1,0,*' --plot free_wheel.png
  carnot geodesic vehicle --from 0,0,0,0 --to 0,1,0,0 --limit 'phi-theta in -0.3:0.3'
  carnot geodesic heisenberg-group --from 0,0,0 --to 1,0,0.2 --all --max-length 10 --output all.csv

Exit status: 0 found (also when fewer than --count exist), 1 nothing converged, 2 bad input,
130 interrupted.)";

struct GeodesicCall {
  RunOptions run;
  std::string from;
  std::string to;
  std::string time = "1";
  std::string count;
  bool all = false;
  std::string max_length;
  std::string starts;
  std::string tolerance;
  std::string minimiser = "newton";
  std::string guess;
  std::string time_limit;
  bool mod_angles = false;
  std::vector<std::string> limits;
  std::vector<std::string> discs;
};

std::string check_minimiser(const std::string& name) {
  const std::vector<std::string> known = minimisers();
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    refuse("--minimiser",
           name,
           "no such minimiser" + language::suggestion(name, known),
           fmt::format("{}", fmt::join(known, ", ")));
  }
  return name;
}

GeodesicOptions check_search(const GeodesicCall& options, const Run& run) {
  GeodesicOptions search;
  if (options.all && !options.count.empty()) {
    refuse("--count", options.count, "given besides --all", "one of the two");
  }
  search.all = options.all;
  if (!options.count.empty()) {
    search.count = static_cast<int>(parse_integer("--count", options.count, 1, kMostGeodesics));
  }
  if (!options.max_length.empty()) {
    search.max_length = parse_positive("--max-length", options.max_length);
  }
  if (!options.starts.empty()) {
    search.starts = static_cast<int>(parse_integer("--starts", options.starts, 1, kMostStarts));
  }
  if (!options.tolerance.empty()) {
    search.absolute_tolerance = parse_tolerance("--tolerance", options.tolerance);
  }
  search.minimiser = check_minimiser(options.minimiser);
  if (!options.guess.empty()) {
    search.guess = parse_vector("--guess", options.guess, coordinate_names(*run.entry));
  }
  search.mod_angles = options.mod_angles;
  if (!options.time_limit.empty()) {
    search.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  search.seed = run.seed;
  search.threads = run.threads;
  search.samples = run.samples;
  return search;
}

GeodesicRequest check(const GeodesicCall& options) {
  GeodesicRequest request;
  request.run = check(options.run);
  request.ends = parse_ends(options.from, options.to, options.time, request.run);
  request.ends.limits = request.run.dynamics.info.limits;
  if (!options.limits.empty() || !options.discs.empty()) {
    request.ends.limits =
        choose_limits(options.run.scene, request.run.parameters, options.limits, options.discs);
  }
  request.options = check_search(options, request.run);
  return request;
}

GeodesicReport search(const GeodesicRequest& request) {
  ProgressBar bar("%", 100, request.run.destination.quiet);
  GeodesicOptions options = request.options;
  options.progress = bar.callback();
  return find_geodesics(problem_between(request.run.dynamics, request.ends), options);
}

void add_search_options(CLI::App& app, GeodesicCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. -3,4,-pi/2,0; * is free");
  add("--to", options.to, "Q1", "configuration at the end; * for a coordinate that is free");
  add("--time", options.time, "T", "how long it takes, > 0 (1)");
  add("--count", options.count, "K", "up to K extremals (1)");
  app.add_flag("--all", options.all, "every extremal that is found, instead of --count");
  add("--max-length", options.max_length, "A", "leave out longer ones");
  add("--starts", options.starts, "N", "paths to start from (as many as the task needs)");
  add("--tolerance",
      options.tolerance,
      "TOL",
      "largest error at the end (1e-10 of the problem's own scales)");
  add("--minimiser",
      options.minimiser,
      "NAME",
      "newton, ceres, nlopt or nlopt:NAME, NAME one of slsqp, lbfgs, mlsl, isres, crs (newton)");
  add("--time-limit", options.time_limit, "SECONDS", "end with what was found by then (none)");
  add("--guess", options.guess, "P0", "momentum to start from instead");
  app.add_flag("--mod-angles", options.mod_angles, "angles agree modulo their periods");
  app.add_option("--limit", options.limits, "keep an expression in a range (repeatable)")
      ->type_name("'EXPR in A:B'")
      ->allow_extra_args(false);
  app.add_option("--disc", options.discs, "keep the body's points out of a disc (repeatable)")
      ->type_name("X,Y,R")
      ->allow_extra_args(false);
}

}  // namespace

void add_geodesic(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<GeodesicCall>();
  options->run.searches = true;
  CLI::App& geodesic =
      *app.add_subcommand("geodesic", "Find geodesics between two configurations.");
  add_search_options(geodesic, *options);
  add_run_options(geodesic, options->run);
  geodesic.footer(kGeodesicFooter);
  geodesic.callback([options, &invocation] {
    const GeodesicRequest request = check(*options);
    const GeodesicReport report = search(request);
    invocation.exit_status = report.status == GeodesicStatus::kInterrupted
                                 ? kInterrupted
                                 : deliver(geodesic_result(request, report, invocation.arguments),
                                           request.run.destination);
  });
}

}  // namespace carnot::apps
