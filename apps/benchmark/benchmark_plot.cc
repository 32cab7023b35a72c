// Work and precision in three panels a scene.
#include <fmt/format.h>

#include <algorithm>

#include "benchmark/benchmark_report.h"
#include "carnot/plots/series_plot.h"

namespace carnot::apps {
namespace {

using plots::Series;
using plots::SeriesPanel;

// What a panel shows of a row.
struct Panel {
  const char* title;
  const char* x_label;
  const char* y_label;
  double (*x)(const BenchmarkRow&);
  double (*y)(const BenchmarkRow&);
};

constexpr Panel kPanels[] = {{"work and precision",
                              "CPU time of a trajectory [s]",
                              "error of (q, p) at the end",
                              [](const BenchmarkRow& row) { return row.seconds; },
                              [](const BenchmarkRow& row) { return row.error; }},
                             {"precision of the evaluations",
                              "evaluations of the right-hand side",
                              "error of (q, p) at the end",
                              [](const BenchmarkRow& row) { return row.evaluations; },
                              [](const BenchmarkRow& row) { return row.error; }},
                             {"energy",
                              "CPU time of a trajectory [s]",
                              "largest |H - H_0|",
                              [](const BenchmarkRow& row) { return row.seconds; },
                              [](const BenchmarkRow& row) { return row.energy_drift; }}};

SeriesPanel draw_panel(const Panel& panel, const BenchmarkScene& scene, bool legend) {
  SeriesPanel drawn;
  drawn.title = fmt::format("{}: {}", scene.problem.trajectory.scene, panel.title);
  drawn.x = {panel.x_label, true};
  drawn.y = {panel.y_label, true};
  std::vector<std::string> methods;  // one color each
  for (const BenchmarkCurve& curve : benchmark_curves(scene.rows)) {
    auto method = std::find(methods.begin(), methods.end(), curve.method);
    if (method == methods.end()) method = methods.insert(method, curve.method);
    Series series;
    series.title = legend ? curve.title() : "";
    series.mark = Series::Mark::kLineAndPoints;
    series.dashed = curve.mode == "batch";
    series.color = static_cast<int>(method - methods.begin());
    series.width = curve.automatic ? 2.2 : 1;
    for (const BenchmarkRow& row : curve.rows) {
      series.x.push_back(panel.x(row));
      series.y.push_back(panel.y(row));
    }
    drawn.series.push_back(series);
  }
  return drawn;
}

}  // namespace

std::string draw_benchmark(const std::string& file, const std::vector<BenchmarkScene>& scenes) {
  plots::SeriesPage page;
  page.title = "Speed against error";
  page.subtitle = "thick: only a tolerance was given; thin: the step was; dashed: in a batch";
  page.columns = std::size(kPanels);
  for (const BenchmarkScene& scene : scenes) {
    for (const Panel& panel : kPanels) {
      page.panels.push_back(draw_panel(panel, scene, &panel == &kPanels[2]));
    }
  }
  return plots::write_series(file, page);
}

}  // namespace carnot::apps
