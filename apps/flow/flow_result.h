// What a flow gave, as JSON and as text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/laws/tangent_map.h"
#include "flow/flow_request.h"
#include "run/delivery.h"

namespace carnot::apps {

struct FlowOutcome {
  std::string message;    // empty: completed
  StepPlan plan;          // count 0: no steps were found for the tolerance
  std::vector<double> z;  // (q, p) at report.time_reached
  FlowSummary summary;
  std::optional<TangentMap> tangent;
  double elapsed_seconds = 0;

  [[nodiscard]] bool completed() const { return message.empty(); }
};

Result flow_result(const FlowRequest& request,
                   const FlowOutcome& outcome,
                   const std::vector<std::string>& arguments);

}  // namespace carnot::apps
