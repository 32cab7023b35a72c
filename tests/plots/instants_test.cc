#include "carnot/plots/instants.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "plot_fixtures.h"

namespace carnot::plots::instants_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// The semicubical parabola (t^2, t^3) has a cusp at t = 0.
Rows cuspidal(double from, double to, std::size_t count) {
  Rows rows;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
    rows.push_back({t * t, t * t * t});
  }
  return rows;
}

TEST(Cusps, AreWhereTheDirectionTurnsBack) {
  EXPECT_THAT(cusps(cuspidal(-1, 1, 41)), ElementsAre(20));
  EXPECT_THAT(cusps(cuspidal(-1, 3, 41)), ElementsAre(10));
  const auto between = cusps(cuspidal(-1.02, 1, 41));
  ASSERT_EQ(between.size(), 1U);
  EXPECT_NEAR(static_cast<double>(between[0]), 20, 1.01);
}

TEST(Cusps, SmoothLinesHaveNone) {
  Rows circle;
  for (int i = 0; i <= 60; ++i) circle.push_back({std::cos(0.1 * i), std::sin(0.1 * i), 1});
  EXPECT_THAT(cusps(circle), IsEmpty());
  EXPECT_THAT(cusps(cuspidal(0.1, 1, 30)), IsEmpty());
}

TEST(Cusps, RestAndHolesAreNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(cusps({}), IsEmpty());
  EXPECT_THAT(cusps({{1, 1}}), IsEmpty());
  EXPECT_THAT(cusps({{1, 1}, {1, 1}, {1, 1}}), IsEmpty());
  EXPECT_THAT(cusps({{0, 0}, {1, 0}, {nan, 0}, {1, 1}, {2, 1}}), IsEmpty());
  // Noise about a place of rest.
  EXPECT_THAT(cusps({{0, 0}, {1, 0}, {1 + 1e-12, 0}, {1, 0}, {1 + 1e-12, 0}, {2, 0}}), IsEmpty());
}

// The scene's body moves along the cuspidal line without turning.
Trajectory parking(std::size_t count, double from = -1, double to = 1, double scale = 20) {
  Trajectory trajectory;
  for (const Row& point : cuspidal(from, to, count)) {
    trajectory.t.push_back(static_cast<double>(trajectory.t.size()));
    trajectory.q.push_back({scale * point[0], scale * point[1], 0});
    trajectory.p.push_back({0, 0, 0});
    trajectory.lambda.emplace_back();
    trajectory.hamiltonian.push_back(0);
  }
  return trajectory;
}

TEST(BodyInstants, AreEndsCuspsAndEvenBetween) {
  const Trajectory trajectory = parking(201, -1, 2);
  const auto rows = body_instants(plane_scene(), trajectory, 9);
  ASSERT_EQ(rows.size(), 9U);
  EXPECT_EQ(rows.front(), 0U);
  EXPECT_EQ(rows.back(), 200U);
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  const auto cusp =
      static_cast<std::size_t>(std::find(rows.begin(), rows.end(), 67) - rows.begin());
  ASSERT_LT(cusp, rows.size());
  const auto way = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t i = a; i < b; ++i) {
      sum += std::hypot(trajectory.q[i + 1][0] - trajectory.q[i][0],
                        trajectory.q[i + 1][1] - trajectory.q[i][1]);
    }
    return sum;
  };
  const double step = way(rows[cusp], rows.back()) / static_cast<double>(8 - cusp);
  for (std::size_t i = cusp; i + 1 < rows.size(); ++i) {
    EXPECT_NEAR(way(rows[i], rows[i + 1]), step, 0.1 * step);
  }
}

TEST(BodyInstants, AreFewerOnAShortWay) {
  const auto count = [](double scale) {
    return body_instants(plane_scene(), parking(201, -1, 1, scale), 12).size();
  };
  EXPECT_EQ(count(0.1), 4U);
  EXPECT_GT(count(2), count(0.5));
  EXPECT_EQ(count(100), 12U);
}

TEST(BodyInstants, TooManyCuspsAreLeftOut) {
  Trajectory trajectory = wave(100);
  for (std::size_t i = 0; i < 100; ++i) {
    trajectory.q[i] = {5 * std::abs(std::sin(0.5 * static_cast<double>(i))), 0, 0};
  }
  EXPECT_LE(body_instants(plane_scene(), trajectory, 6).size(), 6U);
}

TEST(BodyInstants, WithoutABodyOrMotionThereAreTheEnds) {
  EXPECT_THAT(body_instants(scene_of(Drawing::View::kSpace), wave(30), 9), ElementsAre(0, 29));
  EXPECT_THAT(body_instants(plane_scene(), wave(1), 9), ElementsAre(0));
  Trajectory rest = wave(20);
  for (auto& q : rest.q) q = {1, 2, 3};
  EXPECT_THAT(body_instants(plane_scene(), rest, 9), ElementsAre(0, 19));
}

}  // namespace
}  // namespace carnot::plots::instants_test
