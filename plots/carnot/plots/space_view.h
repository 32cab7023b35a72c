// A box of space as it is seen from above, in a place on the page.
//
// The projection is made here and drawn as a picture in the plane, so that the box fills its place
// on the page, every part of it has its place, and spheres are round: parallel rays, elevation
// kElevation, and all lengths along an axis one scale.
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"

namespace carnot::plots {

inline constexpr double kDegree = std::numbers::pi / 180;
inline constexpr double kTurn = 32;       // degrees about the vertical, where all is seen
inline constexpr double kElevation = 26;  // degrees above the floor

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

// The point at fractions of the three axes, each from -1/2 to 1/2.
Row point_in_box(const SpaceFrame& frame, const std::array<double, 3>& fractions);
// A corner of the box by its fractions: whether it is at the upper end of each axis.
std::array<double, 3> corner_of_box(bool x, bool y, bool z);

}  // namespace carnot::plots
