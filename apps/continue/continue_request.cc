#include "continue/continue_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "carnot/shooting/find_geodesics.h"
#include "catalogue/scene_choice.h"
#include "run/search_options.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kMostPoints = 1000000;
constexpr long kMostRank = 10000;
constexpr long kSamples = 257;  // of the start

// The largest difference of two momenta, over the size of the first.
double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double apart = 0;
  double size = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    apart = std::max(apart, std::abs(a[j] - b[j]));
    size = std::max(size, std::abs(a[j]));
  }
  return size > 0 ? apart / size : apart;
}

// The geodesic to start from. Nothing where there is none, and the report says why.
std::optional<Geodesic> start_of(const BoundaryValueProblem& problem,
                                 const ContinueRequest& request,
                                 const Progress& progress,
                                 ContinuationReport& report) {
  constexpr int kToChooseFrom = 16;
  constexpr double kSame = 1e-6;  // of the momentum; guesses are copied from what was printed
  // Where arcs keep to limits no momentum alone leads to the end: a guess tells one of those that
  // are found.
  const bool chosen = !problem.limits.empty() && !request.guess.empty();
  GeodesicOptions search;
  search.count = chosen ? kToChooseFrom : request.rank;
  if (!chosen) search.guess = request.guess;
  search.absolute_tolerance = request.options.absolute_tolerance;
  search.time_limit = request.time_limit;
  search.seed = request.run.seed;
  search.threads = request.run.threads;
  search.samples = kSamples;
  search.progress = [&](double /*fraction*/) { return progress(0); };
  const GeodesicReport found = find_geodesics(problem, search);
  if (found.status == GeodesicStatus::kInterrupted) {
    report.status = ContinuationStatus::kInterrupted;
    return std::nullopt;
  }
  if (found.geodesics.empty()) {
    report.message = "no geodesic was found to start with: " + found.message;
    return std::nullopt;
  }
  if (chosen) {
    for (const Geodesic& geodesic : found.geodesics) {
      if (apart(geodesic.p0, request.guess) <= kSame) return geodesic;
    }
    report.message = fmt::format(
        "none of the {} geodesics that were found at the start has the momentum of --guess: try a "
        "--rank",
        found.geodesics.size());
    return std::nullopt;
  }
  if (found.geodesics.size() < static_cast<std::size_t>(request.rank)) {
    report.message =
        fmt::format("only {} geodesics were found at the start: try a --rank up to that",
                    found.geodesics.size());
    return std::nullopt;
  }
  return found.geodesics[request.rank - 1];
}

}  // namespace

ContinueRequest check(const ContinueCall& options) { return check(options, check(options.run)); }

ContinueRequest check(const ContinueCall& options, Run run) {
  ContinueRequest request;
  request.run = std::move(run);
  const SceneEntry& entry = *request.run.entry;
  const auto names = coordinate_names(entry);
  if (options.along.empty())
    refuse_missing("--along", "to=Q1, from=Q0, time=T, PARAMETER=VALUE or limit:NAME=BOUND");
  if (request.run.dynamics.forced > 0) {
    refuse("SCENE",
           entry.info.name,
           "continuation is not offered with holonomic constraints that need RATTLE",
           "a scene without them");
  }
  request.ends = parse_ends(options.from, options.to, options.time, request.run);
  request.asked = options.asked;
  request.ends.limits = limits_of(request.asked, request.run);
  request.along = parse_along(options.along, request.run, request.ends, request.asked);
  const bool limited = !request.ends.limits.empty();
  if (limited && options.branches) {
    refuse("--branches", "", "given besides limits, along which branches are not told", "none");
  }
  if (!options.guess.empty() && !options.rank.empty()) {
    refuse("--rank", options.rank, "given besides --guess", "one of the two");
  }
  if (!options.guess.empty()) request.guess = parse_vector("--guess", options.guess, names);
  if (!options.rank.empty()) {
    request.rank = static_cast<int>(parse_integer("--rank", options.rank, 1, kMostRank));
  }
  request.options.max_points =
      static_cast<int>(parse_integer("--max-points", options.max_points, 1, kMostPoints));
  if (!options.tolerance.empty()) {
    request.options.absolute_tolerance = parse_tolerance("--tolerance", options.tolerance);
  }
  if (!options.time_limit.empty()) {
    request.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  request.options.branches = options.branches;
  request.options.labels = !options.no_labels;
  return request;
}

ContinuationReport follow(const ContinueRequest& request, const Progress& progress) {
  const ProblemLine line = line_of(request.along, request.run, request.ends, request.asked);
  ContinuationReport report;
  const std::optional<Geodesic> start = start_of(line.at(0), request, progress, report);
  if (!start) return report;
  ContinuationOptions options = request.options;
  options.progress = progress;
  return continue_geodesic(line, *start, options);
}

}  // namespace carnot::apps
