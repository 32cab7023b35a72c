// The result of `carnot benchmark --limits` for people and for other programs.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_limits.h"
#include "text/json_text.h"

namespace carnot::apps {

// Adds "rows".
void add_limits_json(const std::vector<LimitsRow>& rows, Json& json);

std::string limits_text(const std::vector<LimitsRow>& rows);

std::string limits_markdown(const std::vector<LimitsRow>& rows,
                            const std::vector<std::string>& arguments);

}  // namespace carnot::apps
