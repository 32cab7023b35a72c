// Options of every subcommand that searches for geodesics as `carnot geodesic` does.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/geodesic_options.h"
#include "catalogue/limit_choice.h"
#include "run/run_options.h"

namespace carnot::apps {

struct SearchOptions {
  std::string count;
  bool all = false;
  std::string max_length;
  std::string starts;
  std::string tolerance;
  std::string minimiser = GeodesicOptions{}.minimiser;
  std::string time_limit;
  bool mod_angles = false;
  AskedLimits asked;
};

// --limit and --disc.
void add_limit_options(CLI::App& app, AskedLimits& asked);

void add_search_options(CLI::App& app, SearchOptions& options);

// Throws std::invalid_argument, as the next one does.
GeodesicOptions check(const SearchOptions& options, const Run& run);

// The limits of the scene and those that are asked for, with the parameters of the run.
std::vector<Limit> limits_of(const AskedLimits& asked, const Run& run);

}  // namespace carnot::apps
