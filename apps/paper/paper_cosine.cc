// Section 5 with V = -cos r: order, symplectic form, constraints.
#include "paper/paper_cosine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "carnot/laws/laws.h"
#include "carnot/plots/series_plot.h"

namespace carnot::apps {
namespace {

using plots::Series;
using plots::SeriesPage;
using plots::SeriesPanel;

constexpr double kChordTime = 100;
std::vector<double> end_point(PaperWork& work, const char* method, double time, double step) {
  const Dynamics dynamics = paper_dynamics(kCosineScene, method);
  std::vector<double> z = cosine_start(dynamics);
  work.flow(dynamics, StepPlan::of_length(0, time, step), z);
  return z;
}

void add_order(PaperWork& work, PaperPart& part) {
  constexpr double kTime = 10;
  constexpr int kHalvings = 7;
  const std::vector<double> exact = end_point(work, "gauss16", kTime, kCosineStep);
  SeriesPanel panel;
  PaperTable table{"Midpoint rule against Gauss of order 16, T = 10", {"h", "error", "slope"}, {}};
  for (const char* method : {"midpoint", "gauss4", "gauss6"}) {
    Series series;
    series.title = method;
    series.mark = Series::Mark::kLineAndPoints;
    for (int i = 0; i < kHalvings; ++i) {
      series.x.push_back(std::ldexp(0.2, -i));
      series.y.push_back(max_distance(end_point(work, method, kTime, series.x.back()), exact));
    }
    panel.series.push_back(series);
  }
  const Series& midpoint = panel.series.front();
  std::vector<double> log_h;
  std::vector<double> log_error;
  for (std::size_t i = 0; i < midpoint.x.size(); ++i) {
    const double slope = i == 0 ? std::nan("") : std::log2(midpoint.y[i - 1] / midpoint.y[i]);
    table.rows.push_back({midpoint.x[i], midpoint.y[i], slope});
    if (i < 2) continue;  // the leading term does not rule yet
    log_h.push_back(std::log(midpoint.x[i]));
    log_error.push_back(std::log(midpoint.y[i]));
  }
  const double order = fit_line(log_h, log_error).slope;
  part.rows.push_back({"order of the midpoint rule",
                       "second order",
                       fmt::format("{:.3f}", order),
                       holds(std::abs(order - 2) < 0.02),
                       "slope of log(error of (q, p)) over log(h), T = 10, reference Gauss 16",
                       order,
                       2});
  part.tables.push_back(table);
  panel.x = {"h [time]", true, {}};
  panel.y = {"error of (q, p)", true, {}};
  panel.slopes = {{"slope 2", 2, midpoint.x.back(), midpoint.y.back() / 2, midpoint.x.front()}};
  SeriesPage page;
  page.title = "vehicle, V = \u2212cos r: convergence at T = 10";
  page.panels = {panel};
  page.width = 520;
  part.figures.push_back({"convergence",
                          "error of the midpoint rule over h, and of Gauss 4 and 6",
                          [page](const auto& file) { return plots::write_series(file, page); }});
}

void add_symplectic_form(PaperWork& work, PaperPart& part) {
  constexpr double kRoundOff = 64 * kEps;  // relative to |M|^2, which bounds the products in M'JM
  const Dynamics dynamics = paper_dynamics(kCosineScene, "midpoint");
  PaperTable table{"Symplectic form along the midpoint rule, h = 0.05",
                   {"T", "|M|", "|M'JM - J|", "relative"},
                   {}};
  Series absolute{"|M'JM \u2212 J|", {}, {}, Series::Mark::kLineAndPoints};
  Series relative{"|M'JM \u2212 J| / max(1, |M|^2)", {}, {}, Series::Mark::kLineAndPoints};
  double worst = 0;
  for (const double time : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    const StepPlan plan = StepPlan::of_length(0, time, kCosineStep);
    const TangentMap map = work.tangent(dynamics, plan, cosine_start(dynamics));
    const double size = std::sqrt(map.defect / map.relative_defect);
    table.rows.push_back({time, size, map.defect, map.relative_defect});
    absolute.x.push_back(time);
    absolute.y.push_back(map.defect);
    relative.x.push_back(time);
    relative.y.push_back(map.relative_defect);
    worst = std::max(worst, map.relative_defect);
  }
  part.rows.push_back({"|M'JM - J| / max(1, |M|^2), T <= 100",
                       "conserved",
                       fmt::format("{:.1e}", worst),
                       holds(worst <= kRoundOff),
                       "M = d(q,p)(T)/d(q,p)(0) of the discrete map, exact",
                       worst,
                       0});
  part.tables.push_back(table);
  SeriesPage page;
  page.title = "vehicle, V = \u2212cos r: the symplectic form, midpoint rule";
  SeriesPanel panel;
  panel.x = {"T [time]", true, {}};
  panel.y = {"defect", true, {}};
  panel.series = {absolute, relative};
  page.panels = {panel};
  page.width = 520;
  part.figures.push_back({"symplectic_form",
                          "defect of M'JM = J over time, absolute and relative to |M|^2",
                          [page](const auto& file) { return plots::write_series(file, page); }});
}

double chord_constraint(const char* method, double step) {
  const Dynamics dynamics = paper_dynamics(kCosineScene, method);
  const auto steps = std::lround(kChordTime / step);
  return measure_midpoint_constraint(dynamics, {0, cosine_start(dynamics)}, step, steps);
}

void add_chord_constraint(PaperWork& work, PaperPart& part) {
  const std::vector<double> end = end_point(work, "midpoint", kChordTime, kCosineStep);
  const double size = std::max(std::abs(end[2]), std::abs(end[3]));  // the angles, ever growing
  const double rounding = kEps * size / kCosineStep;
  const double midpoint = chord_constraint("midpoint", kCosineStep);
  part.rows.push_back({"|g(q_mid).(q1 - q0)/h|, midpoint rule",
                       "-",
                       fmt::format("{:.1e}", midpoint),
                       holds(midpoint <= 2 * rounding),
                       fmt::format("q_mid = (q0 + q1)/2 is the stage and (q1 - q0)/h its q', so "
                                   "only the rounding of the nodes is left, eps |q|/h = {:.1e}",
                                   rounding),
                       midpoint,
                       0});
  const double coarse = chord_constraint("gauss4", kCosineStep);
  const double fine = chord_constraint("gauss4", kCosineStep / 2);
  const double order = std::log2(coarse / fine);
  part.rows.push_back({"the same for Gauss 4",
                       "-",
                       fmt::format("{:.1e}, falls like h^{:.2f}", coarse, order),
                       holds(std::abs(order - 2) < 0.1),
                       "there q_mid is no stage: the chord leaves the constraints by O(h^2)",
                       order,
                       2});
}

}  // namespace

std::vector<double> vehicle_start(const Dynamics& dynamics,
                                  const std::array<double, 4>& q,
                                  double driving,
                                  double steering) {
  std::vector<double> z(q.begin(), q.end());
  z.resize(8);
  const double theta = q[2];
  const double phi = q[3];
  std::vector<double> velocity{
      driving * std::cos(phi), driving * std::sin(phi), driving * std::sin(phi - theta), steering};
  const std::vector<double> lambda{0, 0};
  dynamics.momentum(0, q, velocity, lambda, std::span(z).last(4));
  return z;
}

std::vector<double> cosine_start(const Dynamics& dynamics) {
  return vehicle_start(dynamics, {0.75, 0, 0.5, 2}, 1.25, -1);
}

PaperPart paper_cosine(PaperWork& work) {
  PaperPart part;
  part.title = "Section 5: the vehicle on V = -cos r, midpoint rule";
  add_order(work, part);
  add_symplectic_form(work, part);
  add_cosine_energy(work, part);
  add_chord_constraint(work, part);
  return part;
}

}  // namespace carnot::apps
