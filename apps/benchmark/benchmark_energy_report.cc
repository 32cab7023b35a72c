#include "benchmark/benchmark_energy_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_report.h"
#include "carnot/plots/series_plot.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

using Cells = std::vector<std::vector<std::string>>;

constexpr const char* kDriftTitle = "largest |H - H0| on the vehicle to T = 1000";
constexpr const char* kGrowthTitle = "|H - H0| / |H0| after so many steps of 0.2";

std::string drift_heading() { return fmt::format("{}, CPU time of the run", kDriftTitle); }
std::string growth_heading() {
  return fmt::format(
      "Round-off: {}, gauss16, root mean square of {} starts; eps sqrt(steps) is a "
      "random walk",
      kGrowthTitle,
      kEnergyStarts);
}

// All rows, or of each curve the one of least drift.
Cells drift_table(const EnergyResult& result, bool all) {
  Cells cells{{"method", "step or tolerance", "drift", "ms"}};
  for (const BenchmarkCurve& curve : benchmark_curves(result.drift.rows)) {
    const auto least =
        std::min_element(curve.rows.begin(), curve.rows.end(), [](const auto& a, const auto& b) {
          return a.energy_drift < b.energy_drift;
        });
    for (const BenchmarkRow& row : curve.rows) {
      if (!all && &row != &*least) continue;
      cells.push_back({curve.method,
                       fmt::format("{:.3g}", row.step_or_tolerance),
                       fmt::format("{:.1e}", row.energy_drift),
                       fmt::format("{:.3g}", 1e3 * row.seconds)});
    }
  }
  return cells;
}

const char* text_of(bool compensated) { return compensated ? "compensated" : "not compensated"; }

double random_walk(long steps) {
  return std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(steps));
}

Cells growth_table(const EnergyResult& result) {
  Cells cells{{"scene", "steps", text_of(true), text_of(false), "eps sqrt(steps)"}};
  for (const EnergyGrowth& with : result.growth) {
    if (!with.compensated) continue;
    for (const EnergyGrowth& without : result.growth) {
      if (without.compensated || without.scene != with.scene || without.steps != with.steps) {
        continue;
      }
      cells.push_back({with.scene,
                       std::to_string(with.steps),
                       fmt::format("{:.1e}", with.drift),
                       fmt::format("{:.1e}", without.drift),
                       fmt::format("{:.1e}", random_walk(with.steps))});
    }
  }
  return cells;
}

plots::SeriesPanel drift_panel(const EnergyResult& result) {
  plots::SeriesPanel panel;
  panel.title = "what a drift costs: vehicle, T = 1000";
  panel.x = {"CPU time of a run [s]", true};
  panel.y = {"largest |H - H_0|", true};
  int color = 0;
  for (const BenchmarkCurve& curve : benchmark_curves(result.drift.rows)) {
    plots::Series series;
    series.title = curve.method;
    series.mark = plots::Series::Mark::kLineAndPoints;
    series.color = color++;
    for (const BenchmarkRow& row : curve.rows) {
      series.x.push_back(row.seconds);
      series.y.push_back(row.energy_drift);
    }
    panel.series.push_back(series);
  }
  return panel;
}

plots::SeriesPanel growth_panel(const EnergyResult& result) {
  plots::SeriesPanel panel;
  panel.title = "round-off: gauss16, h = 0.2";
  panel.x = {"steps", true};
  panel.y = {"|H - H_0| / |H_0|, root mean square", true};
  int color = 0;
  std::string scene;
  for (const EnergyGrowth& point : result.growth) {
    const bool other = panel.series.empty() || scene != point.scene ||
                       panel.series.back().dashed == point.compensated;
    if (other) {
      if (!scene.empty() && scene != point.scene) ++color;
      scene = point.scene;
      plots::Series series;
      series.title = scene + ", " + text_of(point.compensated);
      series.mark = plots::Series::Mark::kLineAndPoints;
      series.color = color;
      series.dashed = !point.compensated;
      panel.series.push_back(series);
    }
    panel.series.back().x.push_back(static_cast<double>(point.steps));
    panel.series.back().y.push_back(point.drift);
  }
  const long first = result.growth.front().steps;
  panel.slopes.push_back({"eps sqrt(steps)",
                          0.5,
                          static_cast<double>(first),
                          random_walk(first),
                          static_cast<double>(result.growth.back().steps)});
  return panel;
}

}  // namespace

void add_energy_json(const EnergyResult& result, Json& json) {
  json["rows"] = Json::array();
  for (const BenchmarkRow& row : result.drift.rows) {
    json["rows"].push_back({{"scene", row.scene},
                            {"method", row.method},
                            {"mode", row.mode},
                            {"peer", row.peer},
                            {"automatic", row.automatic},
                            {"step_or_tolerance", row.step_or_tolerance},
                            {"error", nullptr},
                            {"seconds", row.seconds},
                            {"evaluations", std::lround(row.evaluations)},
                            {"energy_drift", row.energy_drift}});
  }
  json["growth"] = Json::array();
  for (const EnergyGrowth& point : result.growth) {
    json["growth"].push_back({{"scene", point.scene},
                              {"compensated", point.compensated},
                              {"steps", point.steps},
                              {"drift", point.drift}});
  }
}

std::string energy_text(const EnergyResult& result) {
  return fmt::format("Least of each method: {}\n\n{}\n{}\n\n{}",
                     drift_heading(),
                     text_table(drift_table(result, false)),
                     growth_heading(),
                     text_table(growth_table(result)));
}

std::string energy_markdown(const EnergyResult& result, const std::vector<std::string>& arguments) {
  return fmt::format("{}\n## Drift\n\n{}.\n\n{}\n## Round-off\n\n{}.\n\n{}",
                     markdown_head(arguments),
                     drift_heading(),
                     markdown_table(drift_table(result, true)),
                     growth_heading(),
                     markdown_table(growth_table(result)));
}

std::string draw_energy(const std::string& file, const EnergyResult& result) {
  plots::SeriesPage page;
  page.title = "Energy in long runs";
  page.columns = 2;
  page.panels = {drift_panel(result), growth_panel(result)};
  return plots::write_series(file, page);
}

}  // namespace carnot::apps
