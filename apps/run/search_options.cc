#include "run/search_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "carnot/language/nearest.h"
#include "carnot/shooting/find_geodesics.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

constexpr long kMostGeodesics = 10000;
constexpr long kMostStarts = 10000000;

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

}  // namespace

void add_limit_options(CLI::App& app, AskedLimits& asked) {
  app.add_option("--limit", asked.limits, "keep an expression in a range (repeatable)")
      ->type_name("'EXPR in A:B'")
      ->allow_extra_args(false);
  app.add_option("--disc", asked.discs, "keep the body's points out of a disc (repeatable)")
      ->type_name("X,Y,R")
      ->allow_extra_args(false);
}

void add_search_options(CLI::App& app, SearchOptions& options) {
  const auto add = [&](const char* name, std::string& value, const char* type, const char* help) {
    app.add_option(name, value, help)->type_name(type);
  };
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
      "ceres, newton, nlopt or nlopt:NAME, NAME one of slsqp, lbfgs, mlsl, isres, crs (ceres)");
  add("--time-limit", options.time_limit, "SECONDS", "end with what was found by then (none)");
  app.add_flag("--mod-angles", options.mod_angles, "angles agree modulo their periods");
  add_limit_options(app, options.asked);
}

GeodesicOptions check(const SearchOptions& options, const Run& run) {
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
  search.mod_angles = options.mod_angles;
  if (!options.time_limit.empty()) {
    search.time_limit = parse_positive("--time-limit", options.time_limit);
  }
  search.seed = run.seed;
  search.threads = run.threads;
  search.samples = run.samples;
  return search;
}

std::vector<Limit> limits_of(const AskedLimits& asked, const Run& run) {
  if (!asked.any()) return run.dynamics.info.limits;
  return choose_limits(*run.entry, run.parameters, asked);
}

}  // namespace carnot::apps
