// What `carnot geodesic` is asked: the options as texts, and the same checked.
#pragma once

#include <string>

#include "carnot/shooting/geodesic_options.h"
#include "run/ends.h"
#include "run/run_options.h"
#include "run/search_options.h"

namespace carnot::apps {

struct GeodesicCall {
  RunOptions run;
  std::string from;
  std::string to;
  std::string time = "1";
  std::string guess;
  SearchOptions search;
};

struct GeodesicRequest {
  Run run;
  Ends ends;
  GeodesicOptions options;
};

// Throws std::invalid_argument. The second one takes a run that was made before.
GeodesicRequest check(const GeodesicCall& options);
GeodesicRequest check(const GeodesicCall& options, Run run);

}  // namespace carnot::apps
