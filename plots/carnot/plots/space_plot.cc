#include "carnot/plots/space_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace carnot::plots {
namespace {

constexpr double kComparable = 4;  // spans within this factor get one scale

Interval extent(const SceneInfo& info, const std::vector<Curve>& curves, std::size_t axis) {
  Interval values;
  const auto i = static_cast<std::size_t>(info.drawing.axes[axis]);
  for (const Curve& curve : curves) {
    for (const auto& q : curve.trajectory->q) values.include(q[i]);
  }
  return values;
}

bool comparable(double a, double b) { return std::max(a, b) <= kComparable * std::min(a, b); }

}  // namespace

SpaceFrame::SpaceFrame(const SceneInfo& info, const std::vector<Curve>& curves)
    : x(extent(info, curves, 0)), y(extent(info, curves, 1)), z(extent(info, curves, 2)) {
  constexpr double kMargin = 1.1;
  for (Axis* axis : {&x, &y, &z}) axis->widen(kMargin);
  if (comparable(x.span(), y.span())) {
    const double floor = std::max(x.span(), y.span());
    x.widen_to(floor);
    y.widen_to(floor);
  }
  z.lower -= 0.2 * z.span();  // the floor lies below the curve
}

double SpaceFrame::height() const {
  constexpr double kCube = 1.1;
  const double floor = std::max(x.span(), y.span());
  return comparable(x.span(), y.span()) && comparable(floor, z.span()) ? z.span() / floor : kCube;
}

// gnuplot places a plot in space by its canvas, not by margins; a square canvas keeps x and y on
// one scale. How much of the canvas the box takes, at most, over all turns, was measured.
void set_view(
    Script& script, const Picture& page, const SpaceFrame& frame, const Box& box, double turn) {
  constexpr double kElevation = 62;
  constexpr double kBesides = 110;  // tic and axis labels around the floor
  constexpr double kBelow = 45;
  const double height = frame.height();
  const double side =
      std::min((box.width - kBesides) / 0.72, (box.height - kBelow) / (0.28 + 0.37 * height));
  script << "set origin " << (box.x + box.width / 2 - side / 2) / page.width << ", "
         << (box.y + box.height / 2 - side / 2) / page.height << "\nset size " << side / page.width
         << ", " << side / page.height << "\nset view " << kElevation << ", " << turn << ", 1, "
         << height << "\n";
}

Rows space_rows(const SceneInfo& info, const Trajectory& trajectory, const SpaceFrame& frame) {
  const auto& axes = info.drawing.axes;
  Rows rows;
  for (std::size_t i = 0; i < trajectory.q.size(); ++i) {
    const auto& q = trajectory.q[i];
    const auto coordinate = [&](std::size_t j) { return q[static_cast<std::size_t>(axes[j])]; };
    rows.push_back({frame.x.at(coordinate(0)),
                    frame.y.at(coordinate(1)),
                    frame.z.at(coordinate(2)),
                    trajectory.t[i]});
  }
  return rows;
}

Rows shadow_rows(const Rows& points, const SpaceFrame& frame) {
  Rows rows = points;
  for (Row& row : rows) row[2] = row[2] - row[2] + frame.z.lower;  // NaN stays
  return rows;
}

void set_space(Script& script,
               const Picture& page,
               const SceneInfo& info,
               const SpaceFrame& frame,
               const Box& box,
               double turn) {
  const std::array<const Axis*, 3> axes{&frame.x, &frame.y, &frame.z};
  const std::array<std::string, 3> letters{"x", "y", "z"};
  for (std::size_t j = 0; j < axes.size(); ++j) {
    const auto i = static_cast<std::size_t>(info.drawing.axes[j]);
    set_axis(script, letters[j], *axes[j], std::min(box.width, box.height), 120);
    script << "set " << letters[j] << "label "
           << quoted_markup(axes[j]->label(coordinate_symbol(info, i), coordinate_unit(info, i)))
           << (j == 2   ? " rotate by 90 offset 0.5,0"
               : j == 0 ? " offset 0,-0.7"
                        : " offset 1.5,-0.7")
           << "\n";
  }
  script << "set xyplane at " << frame.z.lower << "\n"
         << "set border 31 lw 0.8\nset tics scale 0.6\nset ytics offset 0.6,-0.1\n"
         << "set grid x y lc rgb '#e4e4e4' lt 1 lw 0.6\n";
  set_view(script, page, frame, box, turn);
}

std::vector<LegendEntry> space_legend() {
  return {{std::string("with points pt 7 ps 1.3 lc rgb '") + TimeColors::kStart + "'", "start"},
          {std::string("with points pt 5 ps 1.2 lc rgb '") + TimeColors::kGoal + "'", "goal"},
          {"with lines lw 1.8 lc rgb '#a82296'", "path"},
          {"with lines lw 1 lc rgb '#b4b4b4'", "shadow"}};
}

void draw_space(Script& script, const Rows& points, const SpaceFrame& frame, const Row& end) {
  const Rows shadow = shadow_rows(points, frame);
  const Row end_shadow = shadow_rows({end}, frame).front();
  const std::string start = std::string(" lc rgb '") + TimeColors::kStart + "'";
  const std::string goal = std::string(" lc rgb '") + TimeColors::kGoal + "'";
  Plot plot(script, "splot", {frame.x.lower, frame.y.lower, frame.z.lower});
  plot.add(shadow, "with lines lw 1 lc rgb '#b4b4b4'")
      .add({points.front(), shadow.front()}, "with lines lw 1 dt (4,4)" + start)
      .add({end, end_shadow}, "with lines lw 1 dt (4,4)" + goal)
      .add(points, "using 1:2:3:4 with lines lw 1.8 lc palette")
      .add({points.front()}, "with points pt 7 ps 1.3" + start)
      .add({end}, "with points pt 5 ps 1.2" + goal)
      .draw();
}

Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  const std::vector<Curve> shown = shown_curves(curves);
  const SpaceFrame frame(info, shown);
  const auto draw = [&](Script& script, const Picture& page, const Curve& curve, const Panel& at) {
    set_space(script, page, info, frame, at.box);
    const Rows points = space_rows(info, *curve.trajectory, frame);
    draw_space(script, points, frame, points.back());
  };
  return draw_panels(info, curves, shown.size() == 1 ? 560 : 380, space_legend(), draw);
}

}  // namespace carnot::plots
