// The result of `carnot benchmark` for people, for other programs and as a picture.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_rows.h"
#include "text/json_text.h"

namespace carnot::apps {

// Adds "trajectories", "rows", "equal_error" and "left_out".
void add_benchmark_json(const std::vector<BenchmarkScene>& scenes, Json& json);

// Per scene a table of times at equal error, and what did not arrive.
std::string benchmark_text(const std::vector<BenchmarkScene>& scenes);

// What was run, and by what: the top of a report.
std::string markdown_head(const std::vector<std::string>& arguments);

// The same as Markdown, with a table of all rows.
std::string benchmark_markdown(const std::vector<BenchmarkScene>& scenes,
                               const std::vector<std::string>& arguments);

// Per scene error over time, error over evaluations, energy drift over time. Returns warnings.
std::string draw_benchmark(const std::string& file, const std::vector<BenchmarkScene>& scenes);

}  // namespace carnot::apps
