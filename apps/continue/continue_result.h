// What a continuation gave, as JSON, CSV, text and a plot.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "carnot/shooting/continuation.h"
#include "continue/along.h"
#include "run/delivery.h"

namespace carnot::apps {

struct ContinueRequest {
  Run run;
  Ends ends;
  Along along;
  int rank = 1;
  std::vector<double> guess;                                    // empty: search
  double time_limit = std::numeric_limits<double>::infinity();  // of that search
  ContinuationOptions options;
};

Result continue_result(const ContinueRequest& request,
                       const ContinuationReport& report,
                       const std::vector<std::string>& arguments);

// Action and p(0) against what changes, folds and branch points marked. Returns gnuplot's warnings.
std::string draw_continuation(const std::string& file,
                              const ContinueRequest& request,
                              const ContinuationReport& report);

}  // namespace carnot::apps
