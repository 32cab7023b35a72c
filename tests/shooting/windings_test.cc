// Angles modulo their periods.
#include "carnot/shooting/problem/windings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::windings_test {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

TEST(Windings, NearestImageFirst) {
  const auto images = images_of_target(test::unicycle({0, 0, 0}, {0, 1, 6}), kUnlimited);
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[0].windings, (std::vector<int>{0, 0, -1}));
  EXPECT_DOUBLE_EQ(images[0].to[2], 6 - kTurn);
  EXPECT_EQ(images[1].windings, (std::vector<int>{0, 0, 0}));
}

TEST(Windings, AWholeTurnEachWay) {
  EXPECT_EQ(images_of_target(test::unicycle({0, 0, 0}, {0, 1, 0}), kUnlimited).size(), 3U);
  EXPECT_EQ(images_of_target(test::sideways(), kUnlimited).size(), 9U);
}

TEST(Windings, LongerPathsTurnFurther) {
  EXPECT_EQ(images_of_target(test::unicycle({0, 0, 0}, {0, 1, 0}), 2.1 * kTurn).size(), 5U);
}

// The distance on SE(2) is the least of those on the cover.
TEST(Windings, TheShortestWayRoundIsFound) {
  GeodesicOptions options;
  options.samples = 0;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0.5, 0.2, 5});
  const double cover = find_geodesics(problem, options).geodesics.at(0).action;
  options.mod_angles = true;
  const Geodesic around = find_geodesics(problem, options).geodesics.at(0);
  EXPECT_LT(around.action, cover);
  EXPECT_EQ(around.windings, (std::vector<int>{0, 0, -1}));
  options.mod_angles = false;
  const BoundaryValueProblem image = test::unicycle({0, 0, 0}, {0.5, 0.2, 5 - kTurn});
  EXPECT_NEAR(find_geodesics(image, options).geodesics.at(0).action, around.action, 1e-11);
}

}  // namespace
}  // namespace carnot::internal::windings_test
