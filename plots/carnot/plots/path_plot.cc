#include "carnot/plots/path_plot.h"

#include <algorithm>

namespace carnot::plots {
namespace {

constexpr std::size_t kBodiesInPanel = 13;
const std::string kWheelStyle = "with lines lw 1 dt (6,4) lc rgb '#8c8c8c'";

// The bodies between start and goal.
std::vector<std::size_t> between(const Trajectory& trajectory, std::size_t bodies) {
  std::vector<std::size_t> instants = spread(trajectory.t.size(), bodies);
  if (instants.size() < 3) return {};
  return {instants.begin() + 1, instants.end() - 1};
}

}  // namespace

std::vector<LegendEntry> path_legend(const SceneInfo& info,
                                     const Curve& curve,
                                     const PlaneFrame& frame) {
  const std::string ends = info.drawing.body ? "with linespoints lw 3" : "with points";
  const std::string name = "(" + coordinate_symbol(info, axis_index(info, 0)) + ", " +
                           coordinate_symbol(info, axis_index(info, 1)) + ")";
  std::vector<LegendEntry> entries = {
      {ends + " pt 7 ps 1.1 lc rgb '" + TimeColors::kStart + "'", "start"},
      {ends + " pt 5 ps 1.0 lc rgb '" + TimeColors::kGoal + "'", "goal"},
      {"with lines lw 2.2 lc rgb '#a82296'", "path of " + name}};
  const std::size_t wheels = other_wheels(info, *curve.trajectory, frame).size();
  if (wheels > 0) entries.push_back({kWheelStyle, wheels == 1 ? "other wheel" : "other wheels"});
  return entries;
}

void draw_path(Script& script,
               const SceneInfo& info,
               const Curve& curve,
               const PlaneFrame& frame,
               std::size_t bodies) {
  using Role = Polyline::Role;
  const Trajectory& trajectory = *curve.trajectory;
  const std::size_t last = trajectory.t.size() - 1;
  const double size = std::clamp(frame.box.width / 600, 0.5, 1.0);  // small panels, thin lines
  const auto lines = [&](const std::vector<std::size_t>& instants, Role role, int alpha) {
    return body_rows(info, trajectory, instants, role, frame, alpha);
  };
  const auto width = [size](double points) { return " lw " + number(size * points, 3); };
  const std::string style = "using 1:2:3 with lines lc rgb variable";
  const Rows path = path_rows(info, trajectory, frame);
  Plot plot(script, "plot", {frame.x.lower, frame.y.lower});
  plot.add(lines(between(trajectory, bodies), Role::kBody, 0x70), style + width(1.2))
      .add(lines(between(trajectory, bodies), Role::kWheel, 0x30), style + width(3.2));
  for (const Rows& track : other_wheels(info, trajectory, frame)) plot.add(track, kWheelStyle);
  plot.add(path, "using 1:2:3 with lines lc palette" + width(1.8));
  const auto end = [&](std::size_t row, const std::string& mark, const char* color) {
    plot.add(lines({row}, Role::kBody, 0), style + width(3))
        .add(lines({row}, Role::kWheel, 0), style + width(7))
        .add({path[row]}, mark + number(1.2 * size, 3) + " lc rgb '" + color + "'")
        .add({path[row]}, mark + number(0.6 * size, 3) + " lc rgb '#ffffff'");
  };
  end(0, "with points pt 7 ps ", TimeColors::kStart);
  end(last, "with points pt 5 ps ", TimeColors::kGoal);
  plot.draw();
}

Picture path_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  const std::vector<Curve> shown = shown_curves(curves);
  const bool single = shown.size() == 1;
  const Box room{0, 0, panel_width(shown.size()), single ? 520.0 : 360.0};
  const PlaneFrame frame(PlaneExtent(info, shown), room);
  const auto draw = [&](Script& script, const Picture& page, const Curve& curve, const Panel& at) {
    PlaneFrame placed = frame;
    placed.box.x = at.box.x + (at.box.width - frame.box.width) / 2;
    placed.box.y = at.box.y;
    set_plane(script, page, info, placed);
    if (!at.left) script << "unset ylabel\n";
    if (!at.bottom) script << "unset xlabel\n";
    draw_path(script, info, curve, placed, single ? kBodies : kBodiesInPanel);
  };
  return draw_panels(info, curves, frame.box.height, path_legend(info, shown[0], frame), draw);
}

}  // namespace carnot::plots
