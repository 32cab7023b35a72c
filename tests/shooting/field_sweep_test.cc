#include "carnot/shooting/field/field_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::field_sweep_test {
namespace {

// Of the Heisenberg group, along y = 0 at one height, across the axis of conjugate points.
struct AcrossTheAxis : testing::Test {
  const BoundaryValueProblem problem = test::heisenberg_group({0.25, 0, 0.5});
  const FieldGrid grid{{0, 0, 0.5}, {{0, {0.25, 0.15, 0.05, -0.05, -0.15, -0.25}, false, 0}}};
  const FieldTeam nobody{};
  FieldPartners alone{nobody};
  FieldSweep sweep{problem, grid, 1, alone};

  void SetUp() override {
    const GeodesicReport report = find_geodesics(problem);
    ASSERT_TRUE(sweep.seed(0, report.geodesics.at(0).p0, {0}, 0));
  }
};

// Beyond the axis the extremal goes on as a circle and some more, behind its conjugate point: det J
// has changed its sign, and the mirror image of the way to the other side is shorter.
TEST_F(AcrossTheAxis, DoesNotCarryAnExtremalBeyondItsConjugatePoint) {
  ASSERT_EQ(sweep.spread(1, {}), Spread::kSettled);
  for (const long i : {0L, 1L, 2L}) EXPECT_TRUE(sweep.points().known(i)) << i;
  for (const long i : {3L, 4L, 5L}) EXPECT_FALSE(sweep.points().known(i)) << i;
  EXPECT_EQ(sweep.doubtful(), (std::vector<long>{3, 4, 5}));
}

TEST_F(AcrossTheAxis, SaysWhereSweepsWereNotEnough) {
  EXPECT_EQ(sweep.spread(1, {}, {}, 1), Spread::kTired);
  EXPECT_EQ(sweep.spread(1, {}), Spread::kSettled);
  EXPECT_EQ(sweep.spread(1, [](double) { return false; }), Spread::kStopped);
}

// A search's momentum is made an extremal with a few steps of Gauss, which stiff turns ask more of.
TEST(FieldSweep, MakesExtremalsAgainThatAreNotExact) {
  constexpr double kAllowed = 1e-10;
  const BoundaryValueProblem problem = test::sideways();
  const FieldGrid grid{problem.to, {{1, {1.0}, false, 0}}};
  const GeodesicReport report = find_geodesics(problem);
  const FieldTeam nobody{};
  for (const bool packs : {true, false}) {
    BoundaryValueProblem own = problem;
    own.dynamics.kernel.fills_packs = packs;
    FieldPartners alone(nobody);
    FieldSweep sweep(own, grid, 1, alone);
    ASSERT_TRUE(sweep.seed(0, report.geodesics.at(0).p0, {0}, 0));
    const std::vector<long> points{0};
    const std::vector<double> units(4, 1.0);
    EXPECT_LE(sweep.verify(points, units, kAllowed).at(0), kAllowed);
    EXPECT_NEAR(sweep.points().action(0), report.geodesics[0].action, 1e-9);
    EXPECT_GT(sweep.verify(points, units, 0).at(0), 0);  // no flow is exact
  }
}

TEST(FieldGrid, StepsToNeighbours) {
  constexpr double kTurn = 6;
  const FieldGrid grid{
      {0, 7, 0}, {{0, {1, 2}, false, kTurn}, {2, {4, 2, 0}, true, kTurn}, {1, {5}, false, 0}}};
  EXPECT_EQ(grid.size(), 6);
  EXPECT_EQ(grid.target(4), (std::vector<double>{2, 5, 2}));
  EXPECT_EQ(grid.step(1, 0, 1).index, 4);
  EXPECT_EQ(grid.step(1, 0, 1).length, 1);
  EXPECT_EQ(grid.step(1, 0, -1).index, -1);
  EXPECT_EQ(grid.step(1, 2, 1).index, -1);
  const FieldGrid::Step around = grid.step(3, 1, -1);  // beyond 4 on a falling axis is 0, or 6
  EXPECT_EQ(around.index, 5);
  EXPECT_EQ(around.turns, 1);
  EXPECT_EQ(around.length, 2);
}

// A mirror takes an angle of 4 on a grid of 4, 2, 0 around 6 to -4, a turn below 2.
TEST(FieldGrid, ReflectsPoints) {
  constexpr double kTurn = 6;
  const FieldGrid grid{{0, 7, 0}, {{0, {-1, 0, 1}, false, 0}, {2, {4, 2, 0}, true, kTurn}}};
  const FieldGrid::Image image = grid.image(0, {0, 0}, {-1, 1, -1});
  EXPECT_EQ(image.index, 7);  // 1, 7, 2
  EXPECT_EQ(image.windings, (std::vector<int>{0, -1}));
  EXPECT_EQ(grid.target(image.index, image.windings), (std::vector<double>{1, 7, -4}));
  const FieldGrid::Image same = grid.image(7, {0, -1}, {1, 1, 1});
  EXPECT_EQ(same.index, 7);
  EXPECT_EQ(same.windings, image.windings);
  EXPECT_EQ(grid.image(0, {0, 0}, {-1, -1, 1}).index, -1);  // y = -7 is not on the grid
  const FieldGrid aside{{0, 0, 0}, {{0, {-1, 0, 1.5}, false, 0}}};
  EXPECT_EQ(aside.image(2, {0}, {-1, 1, 1}).index, -1);
}

// y = 0.5 x + its own value, and z = 2 x + 1.
TEST(FieldGrid, LetsCoordinatesFollow) {
  const FieldGrid grid{
      {0, 0, 1}, {{0, {-2, 0, 2}, false, 0}, {1, {-1, 0, 1}, false, 0}}, {{1, 0, 0.5}, {2, 0, 2}}};
  EXPECT_EQ(grid.target(0), (std::vector<double>{-2, -2, -3}));
  EXPECT_EQ(grid.target(7), (std::vector<double>{2, 1, 5}));
  const Eigen::VectorXd along = grid.change(0, 2);
  EXPECT_EQ(along, Eigen::Vector3d(2, 1, 4));
  EXPECT_EQ(grid.change(1, 2), Eigen::Vector3d(0, 2, 0));
  // A mirror of all three takes z = 2 x + 1 to z = 2 x - 1; without the 1 it is on the grid.
  EXPECT_EQ(grid.image(0, {0, 0}, {-1, -1, -1}).index, -1);
  FieldGrid even = grid;
  even.to[2] = 0;
  EXPECT_EQ(even.image(0, {0, 0}, {-1, -1, -1}).index, 8);
  EXPECT_EQ(even.image(1, {0, 0}, {-1, 1, 1}).index, -1);
}

// What is known on one side of the mirror is known on the other.
TEST_F(AcrossTheAxis, IsTheSameInMirrors) {
  ASSERT_EQ(sweep.spread(1, {}), Spread::kSettled);
  EXPECT_EQ(sweep.reflect(2), 3);
  EXPECT_EQ(sweep.reflect(2), 0);
  for (long i = 0; i < 3; ++i) {
    EXPECT_NEAR(sweep.points().action(5 - i), sweep.points().action(i), 1e-10) << i;
  }
}

// Unicycles to a half turn, along a line: turning left and turning right are as short at one point
// of it. A point that keeps two extremals has both.
TEST(FieldSweep, KeepsAsManyWaysAsThereAreBranches) {
  const double half = std::numbers::pi;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0.3, half});
  const FieldGrid grid{problem.to,
                       {{0, {-0.6, -0.3, 0, 0.3, 0.6}, false, 0}, {2, {half}, false, 2 * half}}};
  const auto search = [&](long i, const std::vector<int>& windings) {
    return find_geodesics(test::unicycle({0, 0, 0}, grid.target(i, windings))).geodesics.at(0);
  };
  const std::vector<int> left{0, 0};
  const std::vector<int> right{0, -1};
  const FieldTeam nobody{};
  for (const int branches : {1, 2}) {
    FieldPartners alone(nobody);
    FieldSweep sweep(problem, grid, branches, alone);
    ASSERT_TRUE(sweep.seed(0, search(0, left).p0, left, 0));
    ASSERT_TRUE(sweep.seed(4, search(4, right).p0, right, 1));
    ASSERT_EQ(sweep.spread(1, {}), Spread::kSettled);
    for (long i = 0; i < grid.size(); ++i) {
      const FieldStore& points = sweep.points();
      const double by_left = search(i, left).action;
      const double by_right = search(i, right).action;
      EXPECT_NEAR(points.action(i), std::min(by_left, by_right), 1e-9) << i;
      if (branches == 1) continue;
      const double other = points.action(points.slot(i, 0)) + points.action(points.slot(i, 1));
      EXPECT_NEAR(other, by_left + by_right, 1e-9) << i;
    }
  }
}

}  // namespace
}  // namespace carnot::internal::field_sweep_test
