#include "carnot/plots/animation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/plots/panels.h"
#include "carnot/plots/path_plot.h"
#include "carnot/plots/space_plot.h"

namespace carnot::plots {
namespace {

constexpr std::size_t kFrames = 90;
constexpr std::size_t kRowsOfAFrame = 720;
constexpr std::size_t kStill = 20;          // frames that show the end
constexpr const char* kMoving = "#202020";  // one colour: a .gif holds 256 in all its frames
constexpr double kLegendHeight = 100;
constexpr double kAbove = 75;

// Rows of the trajectory, one per frame, then the last one for a while.
std::vector<std::size_t> frame_rows(const Trajectory& trajectory) {
  std::vector<std::size_t> rows = spread(trajectory.t.size(), kFrames);
  rows.insert(rows.end(), kStill, rows.back());
  return rows;
}

Rows up_to(const Rows& points, std::size_t count) {
  return {points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::string solid(const char* color) { return std::string(" lc rgb '") + color + "'"; }

// Start and end, pale.
void add_ghosts(Plot& plot,
                const SceneInfo& info,
                const Trajectory& trajectory,
                const PlaneFrame& frame) {
  using Role = Polyline::Role;
  const std::size_t last = trajectory.t.size() - 1;
  const char* const colors[] = {"#b6b4dc", "#fad2b4"};
  const std::size_t rows[] = {0, last};
  const Rows path = path_rows(info, trajectory, frame);
  for (int i = 0; i < 2; ++i) {
    const auto lines = [&](Role role) {
      return body_rows(info, trajectory, {rows[i]}, role, frame, 0);
    };
    plot.add(lines(Role::kBody), "using 1:2 with lines lw 3" + solid(colors[i]))
        .add(lines(Role::kWheel), "using 1:2 with lines lw 2" + solid(colors[i]))
        .add({i == 0 ? path.front() : path.back()},
             (i == 0 ? "with points pt 7 ps 1.3" : "with points pt 5 ps 1.2") + solid(colors[i]));
  }
}

void put_time(Script& script, const Picture& page, double t) {
  put_text(script, page, page.width - 20, page.height - 52, "t = " + number(t, 4), "right");
}

}  // namespace

Picture plane_animation(const SceneInfo& info, const Curve& curve) {
  using Role = Polyline::Role;
  const Trajectory trajectory = thinned(*curve.trajectory, kRowsOfAFrame);
  PlaneFrame frame(PlaneExtent(info, {curve}, 0), {90, kLegendHeight, 685, 520});
  frame.box.y = kLegendHeight;
  Picture page;
  page.animated = true;
  page.height = kLegendHeight + frame.box.height + kAbove;
  Script script;
  const Box bar{frame.box.x + frame.box.width + 22, kLegendHeight, 14, frame.box.height};
  std::vector<LegendEntry> legend = path_legend(info, curve, frame);
  std::erase_if(legend, [](const LegendEntry& entry) {  // no tracks are drawn
    return entry.title.find("other wheel") == 0;
  });
  const Rows path = path_rows(info, trajectory, frame);
  for (const std::size_t row : frame_rows(trajectory)) {
    script << "set multiplot\nset key off\nunset label\n";
    set_plane(script, page, info, frame);
    set_time_colors(script, page, times_of({curve}), bar);
    put_title(script, page, info, curve);
    put_time(script, page, trajectory.t[row]);
    Plot plot(script, "plot", {frame.x.lower, frame.y.lower});
    add_ghosts(plot, info, trajectory, frame);
    const auto lines = [&](Role role) {
      return body_rows(info, trajectory, {row}, role, frame, 0);
    };
    const Rows travelled = up_to(path, row + 1);
    plot.add(travelled, "using 1:2:3 with lines lw 2 lc palette")
        .add(lines(Role::kBody), "using 1:2 with lines lw 3" + solid(kMoving))
        .add(lines(Role::kWheel), "using 1:2 with lines lw 2" + solid(kMoving))
        .add({travelled.back()}, "using 1:2 with points pt 7 ps 0.8" + solid(kMoving))
        .draw();
    draw_legend(script, page, page.width / 2, page.width - 40, legend);
    script << "unset multiplot\n";
  }
  page.commands = script.text();
  return page;
}

Picture space_animation(const SceneInfo& info, const Curve& curve) {
  constexpr double kTurned = 50;  // degrees, in all
  constexpr double kFoot = 62;
  const Trajectory trajectory = thinned(*curve.trajectory, kRowsOfAFrame);
  const SpaceFrame frame(info, {curve});
  const double first = frame.turn - kTurned / 4;
  const std::array<double, 2> turns = {first, first + kTurned};
  const Box room{20, kFoot, 755, 540};
  const Box box = SpaceView(frame, room, first, turns).box();
  const Box place{room.x + (room.width - box.width) / 2, kFoot, box.width, box.height};
  Picture page;
  page.animated = true;
  page.height = kFoot + box.height + kAbove;
  Script script;
  const std::vector<std::size_t> rows = frame_rows(trajectory);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double turned = static_cast<double>(i) / static_cast<double>(rows.size());
    const SpaceView view(frame, place, first + kTurned * turned, turns);
    script << "set multiplot\nset key off\nunset label\n";
    set_time_colors(script, page, times_of({curve}), {797, kFoot, 14, box.height});
    put_title(script, page, info, curve);
    put_time(script, page, trajectory.t[rows[i]]);
    draw_space(script, page, info, trajectory, view, rows[i], {rows[i]});
    draw_legend(script, page, page.width / 2, page.width - 40, space_legend(info));
    script << "unset multiplot\n";
  }
  page.commands = script.text();
  return page;
}

}  // namespace carnot::plots
