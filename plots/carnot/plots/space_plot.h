// A curve in space: time as colour, its shadow on the floor, start and goal marked.
#pragma once

#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"
#include "carnot/plots/panels.h"

namespace carnot::plots {

constexpr double kTurn = 32;  // degrees about the vertical

// Axes of a picture in space. One scale on all three where the spans allow it, else on the two of
// the floor where these allow it.
struct SpaceFrame {
  Axis x, y, z;

  SpaceFrame(const SceneInfo& info, const std::vector<Curve>& curves);
  [[nodiscard]] double height() const;  // of the box, over the side of its floor
};

// Points (x, y, z, t).
Rows space_rows(const SceneInfo& info, const Trajectory& trajectory, const SpaceFrame& frame);
// The same on the floor.
Rows shadow_rows(const Rows& points, const SpaceFrame& frame);

// Ranges, tics, labels, and view of a panel in space.
void set_space(Script& script,
               const Picture& page,
               const SceneInfo& info,
               const SpaceFrame& frame,
               const Box& box,
               double turn = kTurn);
std::vector<LegendEntry> space_legend();
// `points` from space_rows(), perhaps only the first ones; `end` is the goal.
void draw_space(Script& script, const Rows& points, const SpaceFrame& frame, const Row& end);

// The whole page.
Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves);

}  // namespace carnot::plots
