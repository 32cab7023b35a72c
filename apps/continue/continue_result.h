// What a continuation gave, as JSON, CSV, text and a plot.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/continuation.h"
#include "continue/continue_request.h"
#include "run/delivery.h"

namespace carnot::apps {

Result continue_result(const ContinueRequest& request,
                       const ContinuationReport& report,
                       const std::vector<std::string>& arguments);

// Action and p(0) against what changes, folds and branch points marked. Returns gnuplot's warnings.
std::string draw_continuation(const std::string& file,
                              const ContinueRequest& request,
                              const ContinuationReport& report);

}  // namespace carnot::apps
