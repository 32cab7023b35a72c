// The results of `carnot benchmark --limits` and `--drift` for people and for other programs.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_direct.h"
#include "text/json_text.h"

namespace carnot::apps {

// Adds "rows".
void add_direct_json(const std::vector<DirectRow>& rows, Json& json);

std::string direct_text(const std::vector<DirectRow>& rows);

std::string direct_markdown(const std::vector<DirectRow>& rows,
                            const std::vector<std::string>& arguments);

}  // namespace carnot::apps
