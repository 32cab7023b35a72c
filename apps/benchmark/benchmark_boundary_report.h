// The result of `carnot benchmark --boundary-value` for people, for other programs and as a
// picture.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_boundary.h"
#include "text/json_text.h"

namespace carnot::apps {

// Adds "problems", "rows" and "curve".
void add_boundary_json(const BoundaryResult& result, Json& json);

// Per problem a table of solvers, then the curve.
std::string boundary_text(const BoundaryResult& result);

std::string boundary_markdown(const BoundaryResult& result,
                              const std::vector<std::string>& arguments);

// Targets at the least action, and solved, over the number of starts and over CPU time. Returns
// warnings.
std::string draw_boundary(const std::string& file, const BoundaryResult& result);

}  // namespace carnot::apps
