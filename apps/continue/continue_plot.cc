// Panels: action and p(0) against what changes and, with limits, when the path keeps to them.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "carnot/plots/curve.h"
#include "carnot/plots/script.h"
#include "carnot/plots/series_plot.h"
#include "carnot/plots/units.h"
#include "continue/continue_result.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

using plots::Series;
using plots::SeriesPanel;

using PointValue = std::function<double(const ContinuationPoint&)>;
using SpecialValue = std::function<double(const SpecialPoint&)>;

constexpr int kFoldColor = 4;
constexpr int kBranchPointColor = 5;
constexpr int kChangeColor = 4;  // there are no folds with limits

// One line for each curve; only the first is in the legend.
void add_curves(const ContinueRequest& request,
                const ContinuationReport& report,
                const std::string& title,
                int color,
                const PointValue& value,
                SeriesPanel& panel) {
  const int last = report.points.empty() ? -1 : report.points.back().branch;
  for (int branch = 0; branch <= last; ++branch) {
    Series series;
    series.title = branch == 0 ? title : "";
    series.color = color;
    series.mark = Series::Mark::kLine;
    for (const ContinuationPoint& point : report.points) {
      if (point.branch != branch) continue;
      series.x.push_back(axis_value(request.along, point.s));
      series.y.push_back(value(point));
    }
    panel.series.push_back(std::move(series));
  }
}

void add_special(const ContinueRequest& request,
                 const std::vector<SpecialPoint>& points,
                 const std::string& title,
                 int color,
                 const std::vector<SpecialValue>& values,
                 SeriesPanel& panel) {
  if (points.empty()) return;
  Series series;
  series.title = title;
  series.color = color;
  series.mark = Series::Mark::kPoints;
  for (const SpecialPoint& point : points) {
    for (const SpecialValue& value : values) {
      series.x.push_back(axis_value(request.along, point.s));
      series.y.push_back(value(point));
    }
  }
  panel.series.push_back(std::move(series));
}

void add_all_special(const ContinueRequest& request,
                     const ContinuationReport& report,
                     const std::vector<SpecialValue>& values,
                     SeriesPanel& panel) {
  add_special(request, report.folds, "fold", kFoldColor, values, panel);
  add_special(request, report.branch_points, "branch point", kBranchPointColor, values, panel);
}

void add_changes(const ContinueRequest& request,
                 const ContinuationReport& report,
                 SeriesPanel& panel) {
  if (report.contact_changes.empty()) return;
  Series series;
  series.title = "an arc comes or goes";
  series.color = kChangeColor;
  series.mark = Series::Mark::kPoints;
  for (const ContactChange& change : report.contact_changes) {
    series.x.push_back(axis_value(request.along, change.s));
    series.y.push_back(change.action);
  }
  panel.series.push_back(std::move(series));
}

SeriesPanel action_panel(const ContinueRequest& request, const ContinuationReport& report) {
  SeriesPanel panel;
  panel.title = "action";
  panel.x.label = axis_label(request.along, request.run);
  panel.y.label = plots::with_unit("action", "energy time");
  add_curves(
      request,
      report,
      "extremals",
      0,
      [](const ContinuationPoint& point) { return point.geodesic.action; },
      panel);
  add_all_special(request, report, {[](const SpecialPoint& p) { return p.action; }}, panel);
  add_changes(request, report, panel);
  return panel;
}

// Arcs as upright strokes from the time where they begin to that where they end.
SeriesPanel contact_panel(const ContinueRequest& request, const ContinuationReport& report) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  SeriesPanel panel;
  panel.title = "on the limits";
  panel.x.label = axis_label(request.along, request.run);
  panel.y.label = "time";
  panel.y.range.include(0);
  panel.y.range.include(request.ends.time);
  for (std::size_t k = 0; k < request.ends.limits.size(); ++k) {
    Series arcs;
    arcs.title = plots::escaped(request.ends.limits[k].name);
    arcs.color = static_cast<int>(k);
    arcs.mark = Series::Mark::kLine;
    Series ends = arcs;
    ends.title = "";
    ends.mark = Series::Mark::kDots;
    for (const ContinuationPoint& point : report.points) {
      const double x = axis_value(request.along, point.s);
      panel.x.range.include(x);
      for (const auto& [begin, end] : point.geodesic.limits[k].active) {
        arcs.x.insert(arcs.x.end(), {x, x, kGap});
        arcs.y.insert(arcs.y.end(), {begin, end, kGap});
        ends.x.insert(ends.x.end(), {x, x});
        ends.y.insert(ends.y.end(), {begin, end});
      }
    }
    if (arcs.x.empty()) continue;
    panel.series.push_back(std::move(arcs));
    panel.series.push_back(std::move(ends));
  }
  return panel;
}

SeriesPanel momentum_panel(const ContinueRequest& request, const ContinuationReport& report) {
  const SceneInfo& info = request.run.entry->info;
  SeriesPanel panel;
  panel.title = "momentum at the start";
  panel.x.label = axis_label(request.along, request.run);
  panel.y.label = "p(0)";
  std::vector<SpecialValue> values;
  for (std::size_t j = 0; j < request.ends.from.size(); ++j) {
    const std::string title =
        plots::with_unit(fmt::format("p_{{{}}}", plots::coordinate_symbol(info, j)),
                         plots::momentum_unit(plots::coordinate_unit(info, j)));
    // The colours of folds and branch points are taken.
    const int color = static_cast<int>(j < kFoldColor ? j : j + 2);
    add_curves(
        request,
        report,
        title,
        color,
        [j](const ContinuationPoint& point) { return point.geodesic.p0[j]; },
        panel);
    values.emplace_back([j](const SpecialPoint& point) { return point.p0[j]; });
  }
  add_all_special(request, report, values, panel);
  return panel;
}

}  // namespace

std::string draw_continuation(const std::string& file,
                              const ContinueRequest& request,
                              const ContinuationReport& report) {
  const Ends& ends = request.ends;
  plots::SeriesPage page;
  page.title = plots::escaped(fmt::format("{}: geodesics from {} to {} in time {:g}",
                                          request.run.entry->info.name,
                                          end_text(ends.from, ends.free_from),
                                          end_text(ends.to, ends.free_to),
                                          ends.time));
  const auto count = [](std::size_t number, const std::string& what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
  };
  const bool limited = !ends.limits.empty();
  const std::string seen = limited
                               ? count(report.contact_changes.size(), "change") + " of contact"
                               : fmt::format("{}, {}",
                                             count(report.folds.size(), "fold"),
                                             count(report.branch_points.size(), "branch point"));
  page.subtitle = plots::escaped(fmt::format("continued along {}: {}, {}",
                                             request.along.name,
                                             count(report.points.size(), "point"),
                                             seen));
  page.panels = {action_panel(request, report), momentum_panel(request, report)};
  const bool kept = std::any_of(report.points.begin(), report.points.end(), [](const auto& point) {
    return std::any_of(point.geodesic.limits.begin(),
                       point.geodesic.limits.end(),
                       [](const LimitReport& limit) { return !limit.active.empty(); });
  });
  if (kept) page.panels.insert(page.panels.begin() + 1, contact_panel(request, report));
  return plots::write_series(file, page);
}

}  // namespace carnot::apps
