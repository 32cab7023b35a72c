#include "carnot/plots/path_plot.h"

#include <algorithm>

#include "carnot/plots/instants.h"

namespace carnot::plots {
namespace {

const std::string kLimitColor = " lc rgb '#f0b070'";
const std::string kWheelStyle = "with lines lw 1 dt (6,4) lc rgb '#8c8c8c'";

// Numbers of gnuplot's filled marks.
constexpr const char* kRound = "7";
constexpr const char* kSquare = "5";

// A mark with a white middle: two points upon each other.
std::vector<std::string> open_mark(const char* mark, double size, const char* color) {
  const std::string point = std::string("with points pt ") + mark + " ps ";
  return {point + number(size, 3) + " " + line_color_of(color),
          point + number(size / 2, 3) + " " + line_color_of("#ffffff")};
}

// The bodies between start and end.
std::vector<std::size_t> between(const SceneInfo& info,
                                 const Trajectory& trajectory,
                                 std::size_t bodies) {
  const std::vector<std::size_t> instants = body_instants(info, trajectory, bodies);
  if (instants.size() < 3) return {};
  return {instants.begin() + 1, instants.end() - 1};
}

}  // namespace

std::vector<LegendEntry> path_legend(const SceneInfo& info,
                                     const Curve& curve,
                                     const PlaneFrame& frame) {
  constexpr double kMark = 1.1;
  const auto body = [&](const char* color) {
    return info.drawing.body ? "with lines lw 2.4 " + line_color_of(color) : std::string();
  };
  const std::string coordinates = "(" + coordinate_symbol(info, axis_index(info, 0)) + ", " +
                                  coordinate_symbol(info, axis_index(info, 1)) + ")";
  const std::string& path = info.drawing.path;
  std::vector<LegendEntry> entries = {
      {body(TimeColors::kStart), open_mark(kRound, kMark, TimeColors::kStart), "start"},
      {body(TimeColors::kEnd), open_mark(kSquare, kMark, TimeColors::kEnd), "end"},
      {"with lines lw 2.2 " + line_color_of(TimeColors::kMiddle),
       {},
       "path of " + (path.empty() ? "" : escaped(path) + " ") + coordinates}};
  const std::size_t wheels = other_wheels(info, *curve.trajectory, frame).size();
  if (wheels > 0)
    entries.push_back({kWheelStyle, {}, wheels == 1 ? "other wheel" : "other wheels"});
  if (!curve.on_limits.empty()) {
    entries.push_back({"with lines lw 6" + kLimitColor, {}, "at a limit"});
  }
  if (info.drawing.body && !info.drawing.glyph.empty()) {
    entries.push_back({"with lines lw 1.4 " + line_color_of(TimeColors::kMiddle),
                       {},
                       escaped(info.drawing.glyph)});
  }
  return entries;
}

void draw_path(Script& script,
               const SceneInfo& info,
               const Curve& curve,
               const PlaneFrame& frame,
               std::size_t bodies) {
  using Role = Polyline::Role;
  constexpr int kVeil = 0x40;
  const Trajectory& trajectory = *curve.trajectory;
  const std::size_t last = trajectory.t.size() - 1;
  const double size = std::clamp(frame.box.width / 600, 0.5, 1.0);  // small panels, thin lines
  const auto lines = [&](const std::vector<std::size_t>& instants, Role role, int alpha) {
    return body_rows(info, trajectory, instants, role, frame, alpha);
  };
  const auto width = [size](double points) { return " lw " + number(size * points, 3); };
  const std::string style = "using 1:2:3 with lines lc rgb variable";
  const std::vector<std::size_t> some = between(info, trajectory, bodies);
  const Rows path = path_rows(info, trajectory, frame);
  Plot plot(script, "plot", {frame.x.lower, frame.y.lower});
  plot.add(lines(some, Role::kBody, kVeil), style + width(1.4))
      .add(lines(some, Role::kWheel, 0), style + width(1.1));
  for (const Rows& track : other_wheels(info, trajectory, frame)) plot.add(track, kWheelStyle);
  const Rows limits = limit_rows(info, curve, frame);
  if (!limits.empty())
    plot.add(limits, "using 1:2 with linespoints pt 7 ps 0.9" + kLimitColor + width(7));
  plot.add(path, "using 1:2:3 with lines lc palette" + width(2.4));
  const auto end = [&](std::size_t row, const char* mark, const char* color) {
    plot.add(lines({row}, Role::kBody, 0), style + width(2.4))
        .add(lines({row}, Role::kWheel, 0), style + width(2));
    for (const std::string& point : open_mark(mark, 1.2 * size, color)) {
      plot.add({path[row]}, point);
    }
  };
  end(0, kRound, TimeColors::kStart);
  end(last, kSquare, TimeColors::kEnd);
  plot.draw();
}

Picture path_picture(const SceneInfo& info, const std::vector<Curve>& curves) {
  const std::vector<Curve> shown = shown_curves(curves);
  const bool single = shown.size() == 1;
  const std::size_t bodies = single ? kBodies : kBodiesInPanel;
  const Sheet sheet;
  const Box room{0, 0, panel_room(shown.size(), sheet), single ? 520.0 : 360.0};
  const PlaneFrame frame(PlaneExtent(info, shown, bodies), room);
  const auto draw = [&](Script& script, const Picture& page, const Curve& curve, const Panel& at) {
    PlaneFrame placed = frame;
    placed.box = at.box;
    set_plane(script, page, info, placed);
    if (!at.left) script << "unset ylabel\n";
    if (!at.bottom) script << "unset xlabel\n";
    draw_path(script, info, curve, placed, bodies);
  };
  return draw_panels(info,
                     curves,
                     sheet,
                     frame.box.width,
                     frame.box.height,
                     path_legend(info, shown[0], frame),
                     draw);
}

}  // namespace carnot::plots
