// A flow that was asked for, advanced and measured.
#pragma once

#include <functional>

#include "flow/flow_request.h"
#include "flow/flow_result.h"

namespace carnot::apps {

// Told how many steps the run will have, or 0 while these are being chosen; gives what is to be
// told of its progress.
using FlowWatch = std::function<Progress(long steps)>;

FlowOutcome run_flow(const FlowRequest& request, const FlowWatch& watch);

}  // namespace carnot::apps
