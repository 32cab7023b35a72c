// What `carnot flow` is asked: the options as texts, and the same checked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carnot/flow/flow.h"
#include "run/run_options.h"

namespace carnot::apps {

struct FlowOptions {
  RunOptions run;
  std::string from;
  std::string momentum;
  std::string velocity;
  std::string lambda;
  std::string time;
  std::string step;
  std::string steps;
  std::string tolerance;
  std::string stage_tolerance;
  std::string start_time = "0";
  bool tangent = false;
};

struct FlowRequest {
  Run run;
  std::vector<double> z;  // (q, p) at start_time
  double start_time = 0;
  double time = 0;
  std::optional<StepPlan> plan;     // or
  std::optional<double> tolerance;  // of the end point
  bool tangent = false;
};

// Throws std::invalid_argument. The second one takes a run that was made before.
FlowRequest check(const FlowOptions& options);
FlowRequest check(const FlowOptions& options, Run run);

}  // namespace carnot::apps
