#include "benchmark/benchmark_boundary_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "benchmark/benchmark_report.h"
#include "carnot/plots/series_plot.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

using Cells = std::vector<std::vector<std::string>>;

const char* start_name(BoundaryStart start) {
  return start == BoundaryStart::kPath ? "path" : "momentum";
}

std::optional<double> seconds_per_success(const BoundaryRow& row) {
  if (row.solved == 0) return std::nullopt;
  return row.cpu_seconds / row.solved;
}

std::string milliseconds(double seconds) { return fmt::format("{:.3g}", 1e3 * seconds); }

Cells solver_table(const BoundaryResult& result, const std::string& scene) {
  Cells cells{{"solver",
               "starts from a",
               "success",
               "CPU ms per start",
               "CPU ms per success",
               "least action found",
               "best action, error"}};
  for (const BoundaryRow& row : result.rows) {
    if (row.scene != scene) continue;
    const auto each = seconds_per_success(row);
    cells.push_back({row.solver + (row.verified ? "" : " (grid)"),
                     start_name(row.start),
                     fmt::format("{:.0f} %", 100.0 * row.solved / row.starts),
                     milliseconds(row.cpu_seconds / row.starts),
                     each ? milliseconds(*each) : "-",
                     fmt::format("{} of {}", row.least_found, row.starts),
                     row.best_action_error ? fmt::format("{:.1e}", *row.best_action_error) : "-"});
  }
  return cells;
}

Cells curve_table(const BoundaryResult& result) {
  Cells cells{{"scene", "starts", "least action", "solved", "CPU ms"}};
  for (const BoundaryPoint& point : result.curve) {
    const auto share = [&point](int count) {
      return fmt::format("{:.0f} %", 100.0 * count / point.targets);
    };
    cells.push_back({point.scene,
                     std::to_string(point.starts),
                     share(point.least),
                     share(point.solved),
                     milliseconds(point.starts * point.cpu_seconds)});
  }
  return cells;
}

std::string heading(const BoundaryProblemEntry& problem) {
  return fmt::format("{} from the origin to {}, least action {}",
                     problem.scene,
                     text_vector(problem.to),
                     text_number(problem.least_action, 12));
}

std::string explanation(bool grids) {
  return fmt::format(
      "A success arrives within 1e-10 by an independent integration{}. The least action counts to "
      "1e-9, relative.",
      grids ? "; those of a grid are the solver's own word, and their least action is the grid's"
            : "");
}

bool has_grids(const BoundaryResult& result) {
  return std::any_of(
      result.rows.begin(), result.rows.end(), [](const auto& row) { return !row.verified; });
}

constexpr const char* kCurveTitle =
    "Random targets, relaxed paths and ceres: targets at the least action that 64 starts find";

}  // namespace

void add_boundary_json(const BoundaryResult& result, Json& json) {
  Json problems = Json::array();
  for (const BoundaryProblemEntry& problem : result.problems) {
    problems.push_back({{"scene", problem.scene},
                        {"from", std::vector<double>(problem.to.size(), 0.0)},
                        {"to", problem.to},
                        {"time", 1},
                        {"least_action", problem.least_action}});
  }
  Json rows = Json::array();
  for (const BoundaryRow& row : result.rows) {
    rows.push_back({{"scene", row.scene},
                    {"solver", row.solver},
                    {"start", start_name(row.start)},
                    {"peer", row.peer},
                    {"verified", row.verified},
                    {"starts", row.starts},
                    {"solved", row.solved},
                    {"success_rate", static_cast<double>(row.solved) / row.starts},
                    {"seconds_per_start", row.cpu_seconds / row.starts},
                    {"seconds_per_success", or_null(seconds_per_success(row))},
                    {"least_found", row.least_found},
                    {"best_action_error", or_null(row.best_action_error)}});
  }
  Json curve = Json::array();
  for (const BoundaryPoint& point : result.curve) {
    curve.push_back({{"scene", point.scene},
                     {"starts", point.starts},
                     {"targets", point.targets},
                     {"solved", point.solved},
                     {"least", point.least},
                     {"seconds_per_start", point.cpu_seconds}});
  }
  json["problems"] = problems;
  json["rows"] = rows;
  json["curve"] = curve;
}

std::string boundary_text(const BoundaryResult& result) {
  std::string text;
  for (const BoundaryProblemEntry& problem : result.problems) {
    text += heading(problem) + "\n\n" + text_table(solver_table(result, problem.scene)) + '\n';
  }
  return text + explanation(has_grids(result)) + "\n\n" + kCurveTitle + "\n\n" +
         text_table(curve_table(result));
}

std::string boundary_markdown(const BoundaryResult& result,
                              const std::vector<std::string>& arguments) {
  std::string text =
      fmt::format("{}\n{}\n", markdown_head(arguments), explanation(has_grids(result)));
  for (const BoundaryProblemEntry& problem : result.problems) {
    text += fmt::format("\n## {}\n\n{}.\n\n{}",
                        problem.scene,
                        heading(problem),
                        markdown_table(solver_table(result, problem.scene)));
  }
  return text +
         fmt::format("\n## Starts\n\n{}.\n\n{}", kCurveTitle, markdown_table(curve_table(result)));
}

std::string draw_boundary(const std::string& file, const BoundaryResult& result) {
  plots::SeriesPage page;
  page.title = "Targets at the least action over the number of starts";
  page.subtitle = "dashed: targets with any solution";
  page.columns = 2;
  for (const bool over_time : {false, true}) {
    plots::SeriesPanel panel;
    panel.x = {over_time ? "CPU time of a target [s]" : "starts", true};
    panel.y = {"share of the random targets"};
    panel.y.range.include(0);
    panel.y.range.include(1.02);
    panel.legend = plots::Legend::kBottomRight;
    int color = 0;
    for (const BoundaryProblemEntry& problem : result.problems) {
      plots::Series least;
      least.title = over_time ? "" : problem.scene;
      least.mark = plots::Series::Mark::kLineAndPoints;
      least.color = color++;
      plots::Series solved = least;
      solved.title = "";
      solved.dashed = true;
      solved.mark = plots::Series::Mark::kLine;
      for (const BoundaryPoint& point : result.curve) {
        if (point.scene != problem.scene) continue;
        const double x = over_time ? point.starts * point.cpu_seconds : point.starts;
        least.x.push_back(x);
        solved.x.push_back(x);
        least.y.push_back(static_cast<double>(point.least) / point.targets);
        solved.y.push_back(static_cast<double>(point.solved) / point.targets);
      }
      panel.series.push_back(solved);
      panel.series.push_back(least);
    }
    page.panels.push_back(panel);
  }
  return plots::write_series(file, page);
}

}  // namespace carnot::apps
