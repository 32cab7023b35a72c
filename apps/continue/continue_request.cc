#include "continue/continue_request.h"

#include <fmt/format.h>

#include <utility>

#include "carnot/shooting/find_geodesics.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kMostPoints = 1000000;
constexpr long kMostRank = 10000;
constexpr long kSamples = 129;  // of the start, for its knots

}  // namespace

ContinueRequest check(const ContinueCall& options) { return check(options, check(options.run)); }

ContinueRequest check(const ContinueCall& options, Run run) {
  ContinueRequest request;
  request.run = std::move(run);
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

ContinuationReport follow(const ContinueRequest& request, const Progress& progress) {
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

}  // namespace carnot::apps
