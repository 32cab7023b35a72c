// carnot stress --suite: the hard cases of stress_case.h, one group after the other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "benchmark/stress_case.h"
#include "text/json_text.h"

namespace carnot::apps {

// All groups; nothing when stopped.
std::optional<std::vector<StressCase>> run_suite(const SuiteOptions& options,
                                                 const Progress& progress);

// {"cases": [...], "held": N, "count": N}.
Json suite_json(const std::vector<StressCase>& cases);
// A table for each group.
std::string suite_text(const std::vector<StressCase>& cases);

}  // namespace carnot::apps
