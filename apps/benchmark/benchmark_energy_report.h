// `carnot benchmark --energy` as JSON, text, Markdown and a plot.
#pragma once

#include <string>
#include <vector>

#include "benchmark/benchmark_energy.h"
#include "text/json_text.h"

namespace carnot::apps {

// Keys "rows" (with a null "error") and "growth".
void add_energy_json(const EnergyResult& result, Json& json);

std::string energy_text(const EnergyResult& result);

std::string energy_markdown(const EnergyResult& result, const std::vector<std::string>& arguments);

// Drift over time, and round-off over steps. Returns warnings.
std::string draw_energy(const std::string& file, const EnergyResult& result);

}  // namespace carnot::apps
