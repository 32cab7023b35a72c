// Parts of bodies, and what a scene is called that says nothing of itself.
#include "carnot/scene/body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/scene/describe_scene.h"

namespace carnot::body_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(AttitudeTest, AnglesAndQuaternionsAgree) {
  const double psi = 0.7;
  const double theta = -0.4;
  const double phi = 1.9;
  // Of Rz(psi) Ry(theta) Rx(phi), times 3.
  const double c1 = std::cos(psi / 2), s1 = std::sin(psi / 2);
  const double c2 = std::cos(theta / 2), s2 = std::sin(theta / 2);
  const double c3 = std::cos(phi / 2), s3 = std::sin(phi / 2);
  const std::array<double, 4> q = {3 * (c1 * c2 * c3 + s1 * s2 * s3),
                                   3 * (c1 * c2 * s3 - s1 * s2 * c3),
                                   3 * (c1 * s2 * c3 + s1 * c2 * s3),
                                   3 * (s1 * c2 * c3 - c1 * s2 * s3)};
  const Attitude by_angles = attitude_of_angles(psi, theta, phi);
  const Attitude by_quaternion = attitude_of_quaternion(q.data());
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(by_angles[j][i], by_quaternion[j][i], 8 * kEps);
      EXPECT_NEAR(dot(by_angles[i], by_angles[j]), i == j ? 1 : 0, 8 * kEps);
    }
  }
}

TEST(BodyTest, ARectangleIsClosedAndHasItsSides) {
  const Polyline box = rectangle({1, 2}, 0.3, 4, 0.5);
  ASSERT_EQ(box.points.size(), 6U);
  EXPECT_EQ(box.points.front(), box.points.back());
  const auto side = [&](std::size_t i) {
    return std::hypot(box.points[i + 1][0] - box.points[i][0],
                      box.points[i + 1][1] - box.points[i][1]);
  };
  EXPECT_NEAR(side(1), 4, 8 * kEps);
  EXPECT_NEAR(side(2), 0.5, 8 * kEps);
  EXPECT_NEAR(side(0) + side(4), side(2), 8 * kEps);
  const double heading =
      std::atan2(box.points[2][1] - box.points[1][1], box.points[2][0] - box.points[1][0]);
  EXPECT_NEAR(heading, 0.3, 8 * kEps);
}

TEST(BodyTest, AGlobeIsInsideItsOutline) {
  const auto lines = globe({1, 2}, 0.5, attitude_of_angles(0.3, 0.8, -2));
  ASSERT_GE(lines.size(), 3U);
  for (const Polyline& line : lines) {
    EXPECT_GE(line.points.size(), 2U);
    for (const auto& [x, y] : line.points) {
      EXPECT_LE(std::hypot(x - 1, y - 2), 0.5 * (1 + 8 * kEps));
    }
  }
}

// No two of the 24 attitudes that turn the axes into each other look the same.
TEST(BodyTest, AGlobeShowsItsAttitude) {
  const auto points_of = [](const Attitude& attitude) {
    std::vector<std::pair<long, long>> points;
    for (const Polyline& line : globe({0, 0}, 100, attitude)) {
      for (const auto& [x, y] : line.points) points.emplace_back(std::lround(x), std::lround(y));
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
  };
  const double quarter = std::acos(0.0);
  std::vector<std::vector<std::pair<long, long>>> seen;
  for (int turn = 0; turn < 4; ++turn) {
    for (int pitch = 0; pitch < 4; ++pitch) {
      seen.push_back(points_of(attitude_of_angles(turn * quarter, pitch * quarter, 0)));
    }
    for (const int roll : {1, 3}) {
      seen.push_back(points_of(attitude_of_angles(turn * quarter, 0, roll * quarter)));
    }
  }
  ASSERT_EQ(seen.size(), 24U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(seen[i], seen[j]) << i << " " << j;
  }
}

TEST(BodyTest, AnArrowIsOnItsSphere) {
  const std::array<double, 3> place = {2, 0, 0};
  const auto lines = arrow_on_sphere(place, {0, 3, 4}, 0.5);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].points.front(), place);
  for (const SpaceLine& line : lines) {
    for (const auto& point : line.points) EXPECT_NEAR(dot(point, point), 4, 16 * kEps);
  }
  const auto& tip = lines[0].points.back();
  EXPECT_EQ(tip, lines[1].points[1]);
  EXPECT_NEAR(std::atan2(std::hypot(tip[1], tip[2]), tip[0]), 0.25, 8 * kEps);
  EXPECT_NEAR(tip[2] / tip[1], 4.0 / 3, 16 * kEps);
}

// The least that a scene has.
template <int n>
struct Line {
  static constexpr int kDof = n;
  static constexpr int kMultipliers = 1;
  template <class T>
  [[nodiscard]] Matrix<T, n, n> mass(const Vector<T, n>& /*q*/) const {
    return Matrix<T, n, n>::Identity();
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, n> constraints(const Vector<T, n>& /*q*/) const {
    return Matrix<T, 1, n>::Ones();
  }
};

struct Coin : Line<2> {};

template <int n>
struct Chain : Line<n> {
  SceneInfo info() const {
    SceneInfo info;
    info.summary = "a chain";
    return info;
  }
};

TEST(SceneInfoTest, AScenesTypeIsItsNameUnlessItHasOne) {
  const SceneInfo coin = describe_scene(Coin{});
  EXPECT_EQ(coin.name, "Coin");
  EXPECT_EQ(coin.kind, "velocity constraints");
  ASSERT_EQ(coin.configuration.size(), 2U);
  EXPECT_EQ(coin.configuration[1].name, "q2");
  const SceneInfo chain = describe_scene(Chain<3>{});
  EXPECT_EQ(chain.name, "Chain<3>");
  EXPECT_EQ(chain.summary, "a chain");
  EXPECT_EQ(chain.configuration.size(), 3U);
}

}  // namespace
}  // namespace carnot::body_test
