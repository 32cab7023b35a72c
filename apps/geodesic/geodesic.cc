// carnot geodesic: extremals that join two configurations, without a guess.
#include <CLI/CLI.hpp>
#include <memory>

#include "geodesic/geodesic_result.h"
#include "run/subcommands.h"
#include "text/progress_bar.h"

namespace carnot::apps {
namespace {

constexpr const char* kGeodesicFooter = R"(
No guess is needed. Distinct extremals are listed, least action first; mirror partners count
separately. Angles live on the cover: 0 and 2 pi are different ends, unless --mod-angles. Every
extremal is checked by an independent integration at a tighter setting: its largest error at the end
is "error" in the table and "endpoint_error" in the JSON. There, "hits" counts the starts that led to
an extremal or a mirror partner, and "missed_estimate" is Chao's estimate of how many were not
found, at least 1 where the first is no minimum or was hit once only, or null where starts say too
little.
On failure "reason" is a code, in the order of how far the best attempt came:
no-start-converged, singular-coordinates (most paths ran into one), guess-failed, not-refined,
flow-failed, not-joined, not-verified, beyond-double (round-off exceeds the tolerance),
method-too-coarse (its error does), too-long (for --max-length); "message" says more and what to try.
The label "abnormal" is of a path that the constraints alone make an extremal: no momentum leads along
it, and "p0" is null.
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

GeodesicReport search(const GeodesicRequest& request) {
  ProgressBar bar("%", 100, request.run.destination.quiet);
  GeodesicOptions options = request.options;
  options.progress = bar.callback();
  return find_geodesics(problem_between(request.run.dynamics, request.ends), options);
}

void add_ends(CLI::App& app, GeodesicCall& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
  add("--from", options.from, "Q0", "configuration at the start, e.g. -3,4,-pi/2,0; * is free");
  add("--to", options.to, "Q1", "configuration at the end; * for a coordinate that is free");
  add("--time", options.time, "T", "how long it takes, > 0 (1)");
  add("--guess", options.guess, "P0", "momentum to start from instead of paths");
}

}  // namespace

void add_geodesic(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<GeodesicCall>();
  options->run.searches = true;
  CLI::App& geodesic =
      *app.add_subcommand("geodesic", "Find geodesics between two configurations.");
  add_ends(geodesic, *options);
  add_search_options(geodesic, options->search);
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
