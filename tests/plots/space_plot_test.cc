#include "carnot/plots/space_plot.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "plot_fixtures.h"

namespace carnot::plots::space_plot_test {
namespace {

using View = Drawing::View;

constexpr Box kRoom{100, 50, 600, 400};

SceneInfo space_scene(double sphere = 0) {
  SceneInfo info = scene_of(View::kSpace);
  info.configuration[2].unit = "length";
  info.drawing.sphere = sphere;
  return info;
}

SpaceFrame frame_of(const SceneInfo& info, const Trajectory& trajectory) {
  return SpaceFrame(info, {curve_of(trajectory)});
}

double length(const SpaceView& view, const Row& from, const Row& to) {
  const Row a = view.at(from);
  const Row b = view.at(to);
  return std::hypot(b[0] - a[0], b[1] - a[1]);
}

// A body of parallel rays is a circle: all points of the sphere are inside, and some of them, all
// around, are on it.
TEST(SpaceView, ASphereIsRound) {
  constexpr double kRadius = 2;
  const Trajectory trajectory = wave(30, 0, 0.5);
  const SpaceFrame frame = frame_of(space_scene(kRadius), trajectory);
  for (const double turn : {0.0, 32.0, 75.0, 130.0}) {
    const SpaceView view(frame, kRoom, turn, {turn, turn});
    constexpr int kMeridians = 180;
    double largest[8] = {};
    const Row centre = view.at({0, 0, 0});
    for (int i = 0; i < kMeridians; ++i) {
      for (int j = 0; j <= kMeridians; ++j) {
        const double a = i * 2 * std::numbers::pi / kMeridians;
        const double b = j * std::numbers::pi / kMeridians;
        const Row at = view.at({kRadius * std::cos(a) * std::sin(b),
                                kRadius * std::sin(a) * std::sin(b),
                                kRadius * std::cos(b)});
        const double angle = std::atan2(at[1] - centre[1], at[0] - centre[0]);
        double& most = largest[static_cast<int>((angle / std::numbers::pi + 1) * 3.999)];
        most = std::max(most, std::hypot(at[0] - centre[0], at[1] - centre[1]));
      }
    }
    for (const double r : largest) EXPECT_NEAR(r, largest[0], 1e-3 * largest[0]);
  }
}

TEST(SpaceView, EqualAxesHaveOneScale) {
  for (const double sphere : {0.0, 1.0}) {
    const SpaceFrame frame = frame_of(space_scene(sphere), wave(30));
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_NEAR(frame.drawn[i] / frame.axes[i].span(),
                  frame.drawn[0] / frame.axes[0].span(),
                  1e-12 * frame.drawn[0] / frame.axes[0].span());
    }
  }
}

TEST(SpaceView, OtherUnitsAndOtherSizesHaveScalesOfTheirOwn) {
  SceneInfo info = space_scene();
  info.configuration[2].unit = "length^2";
  Trajectory trajectory = wave(30);
  const SpaceFrame flat = frame_of(info, trajectory);
  EXPECT_EQ(flat.drawn[2], 0.8);
  for (auto& q : trajectory.q) q[1] *= 100;
  const SpaceFrame wide = frame_of(info, trajectory);
  EXPECT_EQ(wide.drawn[0], wide.drawn[1]);
}

TEST(SpaceView, ThePathIsInTheBoxAndTheBoxFillsTheRoom) {
  for (const double sphere : {0.0, 1.5}) {
    for (const double turn : {20.0, 32.0, 70.0}) {
      const Trajectory trajectory = wave(60);
      const SceneInfo info = space_scene(sphere);
      const SpaceView view(frame_of(info, trajectory), kRoom, turn, {turn, turn});
      const Box& box = view.box();
      EXPECT_GE(box.x, kRoom.x - 1e-9);
      EXPECT_GE(box.y, kRoom.y - 1e-9);
      EXPECT_TRUE(box.width > kRoom.width - 1e-9 || box.height > kRoom.height - 1e-9);
      EXPECT_LE(box.width, kRoom.width + 1e-9);
      EXPECT_LE(box.height, kRoom.height + 1e-9);
      for (const Row& point : space_rows(info, trajectory)) {
        const Row at = view.at(point);
        EXPECT_GT(at[0], box.x);
        EXPECT_LT(at[0], box.x + box.width);
        EXPECT_GT(at[1], box.y);
        EXPECT_LT(at[1], box.y + box.height);
      }
    }
  }
}

TEST(SpaceView, NearAndFarAreTheTwoSidesOfASphere) {
  const SpaceView view(frame_of(space_scene(1), wave(30)), kRoom, 32, {32, 32});
  EXPECT_TRUE(view.near({0, 0, 1}));
  EXPECT_FALSE(view.near({0, 0, -1}));
  EXPECT_FALSE(view.near({0, 1, 0}));
  EXPECT_TRUE(view.near({1, 0, 0}));
  EXPECT_TRUE(view.near_upper(0));
  EXPECT_FALSE(view.near_upper(1));
  EXPECT_TRUE(view.near_upper(2));
  EXPECT_GT(length(view, {0, 0, 0}, {0, 0, 1}), 0);
}

TEST(SpaceView, ShowsTheSideOfASphereWhereThePathIs) {
  for (const double longitude : {0.3, 1.1, 2.4, 3.5, 4.7, 6.0}) {
    Trajectory trajectory = wave(3);
    for (auto& q : trajectory.q) q = {std::cos(longitude), std::sin(longitude), 0};
    const SpaceView view(frame_of(space_scene(1), trajectory), kRoom);
    EXPECT_TRUE(view.near({std::cos(longitude), std::sin(longitude), 0})) << longitude;
  }
}

// In all turns of a film the box keeps its size.
TEST(SpaceView, AFilmKeepsItsScale) {
  const SpaceFrame frame = frame_of(space_scene(), wave(30));
  const SpaceView first(frame, kRoom, 20, {20, 70});
  const SpaceView last(frame, kRoom, 70, {20, 70});
  EXPECT_EQ(first.box().width, last.box().width);
  EXPECT_NEAR(length(first, {0, 0, 0}, {0, 0, 1}), length(last, {0, 0, 0}, {0, 0, 1}), 1e-9);
}

TEST(SpaceTics, ThereAreThreeAtLeast) {
  for (const double span : {0.3, 0.41, 1.0, 2.9, 7.7, 1e5}) {
    for (const double lower : {-0.9, 0.0, 0.37}) {
      Interval values;
      values.include(lower * span);
      values.include((lower + 1) * span);
      const Axis axis(values);
      const double step = tic_step(axis, 3, 3);
      const double count = std::floor(axis.upper / step) - std::ceil(axis.lower / step) + 1;
      EXPECT_GE(count, 3) << span << " " << lower;
      EXPECT_LE(count, 8) << span << " " << lower;
    }
  }
  EXPECT_EQ(tic_number(-0.30000000000000004, 1), "−0.3");
  EXPECT_EQ(tic_number(1e-17, 1), "0");
}

}  // namespace
}  // namespace carnot::plots::space_plot_test
