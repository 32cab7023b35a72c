#include "carnot/plots/space_plot.h"

#include <algorithm>
#include <cmath>

#include "carnot/plots/instants.h"
#include "carnot/plots/space_box.h"
#include "carnot/plots/sphere.h"

namespace carnot::plots {
namespace {

using Point = std::array<double, 3>;

const std::string kGrid = "with lines lw 0.6 lc rgb '#e4e4e4'";
const std::string kEdge = "with lines lw 0.8 lc rgb '#9a9a9a'";
const std::string kTic = "with lines lw 1 lc rgb '#000000'";
const std::string kShadow = "with lines lw 1 lc rgb '#b4b4b4'";

std::string start_color() { return " " + line_color_of(TimeColors::kStart); }
std::string end_color() { return " " + line_color_of(TimeColors::kEnd); }

double time_fraction(const Trajectory& trajectory, double t) {
  const double span = trajectory.t.back() - trajectory.t.front();
  return span == 0 ? 0 : (t - trajectory.t.front()) / span;
}

// The last number of each row becomes a pale colour.
Rows paled(const Rows& rows, const Trajectory& trajectory) {
  Rows pale = rows;
  for (Row& row : pale) {
    if (!row.empty()) row.back() = TimeColors::pale(time_fraction(trajectory, row.back()));
  }
  return pale;
}

Rows floor_rows(const SpaceView& view, const Rows& points) {
  const Axis& z = view.frame().axes[2];
  Rows rows;
  for (const Row& point : points) {
    const double floor = z.offset + z.lower;
    rows.push_back(view.at({point[0], point[1], point[2] - point[2] + floor}));  // NaN stays
  }
  return rows;
}

// The body at a row, coloured by its time; pale on the far side of a sphere.
Rows body_in_space(const SceneInfo& info,
                   const Trajectory& trajectory,
                   const SpaceView& view,
                   std::size_t row,
                   bool near) {
  Rows rows;
  const auto& q = trajectory.q[row];
  if (body_points(info, q).empty()) return rows;
  const double fraction = time_fraction(trajectory, trajectory.t[row]);
  const double color = near ? TimeColors::argb(fraction, 0) : TimeColors::pale(fraction);
  for (const SpaceLine& line : info.drawing.body_in_space(q.data())) {
    for (const Point& point : line.points) {
      Row at = view.at({point.begin(), point.end()});
      at.push_back(color);
      rows.push_back(at);
    }
    rows.push_back(gap());
  }
  return rows;
}

}  // namespace

Rows space_rows(const SceneInfo& info, const Trajectory& trajectory) {
  Rows rows;
  for (std::size_t i = 0; i < trajectory.q.size(); ++i) {
    rows.push_back(path_point(info, trajectory.q[i]));
    rows.back().push_back(trajectory.t[i]);
  }
  return rows;
}

std::vector<LegendEntry> space_legend(const SceneInfo& info) {
  const Drawing& drawing = info.drawing;
  std::vector<LegendEntry> entries = {
      {"", {"with points pt 7 ps 1.2" + start_color()}, "start"},
      {"", {"with points pt 5 ps 1.1" + end_color()}, "end"},
      {"with lines lw 2.2 " + line_color_of(TimeColors::kMiddle),
       {},
       drawing.path.empty() ? "path" : "path of " + escaped(drawing.path)}};
  if (drawing.sphere == 0) entries.push_back({kShadow, {}, "shadow"});
  if (drawing.body_in_space && !drawing.glyph.empty()) {
    entries.push_back(
        {"with lines lw 1.4 " + line_color_of(TimeColors::kMiddle), {}, escaped(drawing.glyph)});
  }
  return entries;
}

void draw_space(Script& script,
                const Picture& page,
                const SceneInfo& info,
                const Trajectory& trajectory,
                const SpaceView& view,
                std::size_t last,
                const std::vector<std::size_t>& bodies) {
  const double size = std::clamp(view.box().width / 560, 0.6, 1.0);  // small panels, thin lines
  const auto scaled = [size](double points) { return number(size * points, 3); };
  const double radius = info.drawing.sphere;
  const bool sphere = radius > 0;
  const Box& box = view.box();
  script << "unset xtics\nunset ytics\nunset border\nunset grid\nset xlabel ''\nset ylabel ''\n"
         << "set size noratio\nset xrange [" << box.x << ":" << box.x + box.width
         << "]\nset yrange [" << box.y << ":" << box.y + box.height << "]\n";
  set_box(script, page, box);
  Rows tics;
  Rows grid;
  label_box(script, page, info, view, tics, grid);
  const Rows points = space_rows(info, trajectory);
  const Row& end = points.back();
  Sides path;
  path.add(view, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(last) + 1}, sphere);
  Plot plot(script, "plot", {box.x, box.y});
  if (!sphere) plot.add(grid, kGrid);
  plot.add(box_edges(view), kEdge).add(tics, kTic);
  const auto add_bodies = [&](bool near) {
    for (const std::size_t row : bodies) {
      if (sphere && view.near(points[row]) != near) continue;
      if (!sphere && !near) continue;
      const bool at_end = row == 0 || row + 1 == points.size();
      plot.add(body_in_space(info, trajectory, view, row, near),
               "using 1:2:3 with lines lc rgb variable lw " + scaled(at_end ? 2.6 : 1.4));
    }
  };
  if (sphere) {
    const Sides lines = sphere_grid(view, radius);
    plot.add(sphere_outline(view, radius),
             "with filledcurves closed fs solid noborder fc rgb '#f7f7f7'")
        .add(lines.far, "with lines lw 0.5 lc rgb '#e9e9e9'")
        .add(paled(path.far, trajectory),
             "using 1:2:3 with lines lc rgb variable lw " + scaled(1.6));
    add_bodies(false);
    plot.add(lines.near, "with lines lw 0.6 lc rgb '#cfcfcf'")
        .add(sphere_outline(view, radius), "with lines lw 0.8 lc rgb '#b4b4b4'");
  } else {
    const Rows shadow =
        floor_rows(view, {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(last) + 1});
    plot.add(shadow, kShadow)
        .add({view.at(points.front()), floor_rows(view, {points.front()})[0]},
             "with lines lw 1 dt (4,4)" + start_color())
        .add({view.at(end), floor_rows(view, {end})[0]}, "with lines lw 1 dt (4,4)" + end_color());
  }
  plot.add(path.near, "using 1:2:3 with lines lc palette lw " + scaled(2.2));
  add_bodies(true);
  plot.add({view.at(points.front())}, "with points pt 7 ps " + scaled(1.2) + start_color())
      .add({view.at(end)}, "with points pt 5 ps " + scaled(1.1) + end_color());
  plot.draw();
  clear_settings(script);
}

Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  constexpr std::size_t kBodies = 9;
  constexpr std::size_t kBodiesInPanel = 7;
  const std::vector<Curve> shown = shown_curves(curves);
  const bool single = shown.size() == 1;
  Sheet sheet;
  sheet.left = 20;
  sheet.below = 62;
  sheet.gap_x = 30;
  sheet.gap_y = 50;
  const SpaceFrame frame(info, shown);
  const Box room{0, 0, panel_room(shown.size(), sheet), single ? 540.0 : 420.0};
  const Box box = SpaceView(frame, room).box();
  const auto draw = [&](Script& script, const Picture& page, const Curve& curve, const Panel& at) {
    const SpaceView view(frame, at.box);
    const Trajectory& trajectory = *curve.trajectory;
    draw_space(script,
               page,
               info,
               trajectory,
               view,
               trajectory.t.size() - 1,
               body_instants(info, trajectory, single ? kBodies : kBodiesInPanel));
  };
  return draw_panels(info, curves, sheet, box.width, box.height, space_legend(info), draw);
}

}  // namespace carnot::plots
