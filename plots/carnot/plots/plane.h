// Pictures in the plane: axes of one scale, the path and the bodies along it as lines.
#pragma once

#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"

namespace carnot::plots {

// Bodies drawn along a path at most, both ends included: on a page of its own, or in a panel.
constexpr std::size_t kBodies = 9;
constexpr std::size_t kBodiesInPanel = 7;

// Which coordinate is drawn on axis 0, 1, 2.
std::size_t axis_index(const SceneInfo& info, std::size_t axis);

// What the axes of a picture in the plane must hold.
struct PlaneExtent {
  Interval x, y;

  // The curves, and the bodies at their instants (see body_instants), at most so many; 0: all
  // along.
  PlaneExtent(const SceneInfo& info, const std::vector<Curve>& curves, std::size_t bodies);
};

// Axes for the extent, with equal scale in the largest box inside `room`; the box is returned.
struct PlaneFrame {
  Axis x, y;
  Box box;

  PlaneFrame(const PlaneExtent& extent, const Box& room);
};

// Lines of the bodies of given role at given rows of the trajectory, in drawn coordinates: points
// (x, y, colour), a gap after each line. `alpha` 0 is opaque. Wheels are outlines.
Rows body_rows(const SceneInfo& info,
               const Trajectory& trajectory,
               const std::vector<std::size_t>& instants,
               Polyline::Role role,
               const PlaneFrame& frame,
               int alpha);
// Points (x, y, t) of the path.
Rows path_rows(const SceneInfo& info, const Trajectory& trajectory, const PlaneFrame& frame);
// Tracks of the wheels that are not at the reference point.
std::vector<Rows> other_wheels(const SceneInfo& info,
                               const Trajectory& trajectory,
                               const PlaneFrame& frame);
// Points (x, y) of the path where it keeps to a limit, a gap after each stretch.
Rows limit_rows(const SceneInfo& info, const Curve& curve, const PlaneFrame& frame);
// Axes, labels and grid of a panel in the plane, and the regions that limits forbid.
void set_plane(Script& script, const Picture& page, const SceneInfo& info, const PlaneFrame& frame);

}  // namespace carnot::plots
