// Options of every subcommand that searches for geodesics as `carnot geodesic` does.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/geodesic_options.h"
#include "run/run_options.h"

namespace carnot::apps {

struct SearchOptions {
  std::string count;
  bool all = false;
  std::string max_length;
  std::string starts;
  std::string tolerance;
  std::string minimiser = "newton";
  std::string time_limit;
  bool mod_angles = false;
  std::vector<std::string> limits;
  std::vector<std::string> discs;
};

void add_search_options(CLI::App& app, SearchOptions& options);

// Throws std::invalid_argument, as the next one does.
GeodesicOptions check(const SearchOptions& options, const Run& run);

// The limits of the scene and those that are asked for.
std::vector<Limit> limits_of(const SearchOptions& options, const Run& run);

}  // namespace carnot::apps
