// A curve in space, in a box seen from above: time as colour, start and goal marked, and either its
// shadow on the floor or the sphere it lies on.
//
// The projection is made here and drawn as a picture in the plane, so that the box fills its place
// on the page, every part of it has its place, and spheres are round: parallel rays, elevation
// kElevation, and all lengths along an axis one scale.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"
#include "carnot/plots/panels.h"

namespace carnot::plots {

constexpr double kTurn = 32;       // degrees about the vertical, where all is seen
constexpr double kElevation = 26;  // degrees above the floor

// Axes of a picture in space, and how long their ranges are drawn. One scale on all three where the
// units are the same and the spans are comparable, else on the two of the floor where these are;
// always on all three around a sphere.
struct SpaceFrame {
  std::array<Axis, 3> axes;
  std::array<double, 3> drawn{1, 1, 1};
  double sphere = 0;    // its radius; 0: there is none, and the box has walls
  double turn = kTurn;  // the view that hides least

  SpaceFrame(const SceneInfo& info, const std::vector<Curve>& curves);
};

// The name and unit of what is drawn on axis 0, 1, 2.
Coordinate space_coordinate(const SceneInfo& info, std::size_t axis);

// A frame as it is seen, in a place on the page.
class SpaceView {
 public:
  // As large as `room` allows, with numbers and labels; in a film, for all turns in the range
  // given.
  SpaceView(const SpaceFrame& frame, const Box& room)
      : SpaceView(frame, room, frame.turn, {frame.turn, frame.turn}) {}
  SpaceView(const SpaceFrame& frame,
            const Box& room,
            double turn,
            const std::array<double, 2>& turns);

  // The place on the page of a point (x, y, z, ...).
  [[nodiscard]] Row at(const Row& point) const;
  // Whether a point is on the near side of the sphere about the origin that it lies on.
  [[nodiscard]] bool near(const Row& point) const;
  [[nodiscard]] const SpaceFrame& frame() const { return frame_; }
  // What it takes of the room, in the middle of it.
  [[nodiscard]] const Box& box() const { return box_; }
  // Whether the upper end of axis i is nearer to the viewer than the lower one.
  [[nodiscard]] bool near_upper(std::size_t i) const;

 private:
  // Right and up on the page, and towards the viewer, from the middle of the box.
  [[nodiscard]] std::array<double, 3> projected(const std::array<double, 3>& drawn) const;

  SpaceFrame frame_;
  double turn_;       // radians
  double scale_ = 1;  // from drawn lengths to the page
  std::array<double, 2> middle_{};
  Box box_;
};

// Points (x, y, z, t).
Rows space_rows(const SceneInfo& info, const Trajectory& trajectory);

std::vector<LegendEntry> space_legend(const SceneInfo& info);

// The box with walls, tics and labels, the path as far as row `last`, both ends, and the bodies at
// the given rows. The plot is in the units of the page.
void draw_space(Script& script,
                const Picture& page,
                const SceneInfo& info,
                const Trajectory& trajectory,
                const SpaceView& view,
                std::size_t last,
                const std::vector<std::size_t>& bodies);

// The whole page.
Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves);

}  // namespace carnot::plots
