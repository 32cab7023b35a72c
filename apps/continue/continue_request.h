// What `carnot continue` is asked: the options as texts, the same checked, and what is followed.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "carnot/shooting/continuation.h"
#include "continue/along.h"

namespace carnot::apps {

struct ContinueCall {
  RunOptions run;
  std::string from;
  std::string to;
  std::string time = "1";
  std::string along;
  std::string rank;
  std::string guess;
  std::string max_points = "1000";
  std::string tolerance;
  std::string time_limit;
  bool branches = false;
  bool no_labels = false;
  AskedLimits asked;
};

struct ContinueRequest {
  Run run;
  Ends ends;
  AskedLimits asked;
  Along along;
  int rank = 1;
  std::vector<double> guess;                                    // empty: search
  double time_limit = std::numeric_limits<double>::infinity();  // of that search
  ContinuationOptions options;
};

// Throws std::invalid_argument. The second one takes a run that was made before.
ContinueRequest check(const ContinueCall& options);
ContinueRequest check(const ContinueCall& options, Run run);

// Finds the geodesic to start from, then follows the curve.
ContinuationReport follow(const ContinueRequest& request, const Progress& progress);

}  // namespace carnot::apps
