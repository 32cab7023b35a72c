#include "carnot/shooting/field/field_wave.h"

#include <gtest/gtest.h>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::field_wave_test {
namespace {

// Three points of the Heisenberg group. The first one has its geodesic, the last one the second
// extremal, which is longer, and the middle one has nothing.
struct Between : testing::Test {
  const BoundaryValueProblem problem = test::heisenberg_group({0.5, 0.1, 0.5});
  const FieldGrid grid{{0.5, 0.1, 0.5}, {{0, {0.45, 0.5, 0.55}, false, 0}}};
  FieldStore points{3, 3, 1, 1};
  FieldCounts counts;
  FieldWave wave{problem, grid, points, counts};

  [[nodiscard]] GeodesicReport search(long i) const {
    GeodesicOptions options;
    options.count = 2;
    return find_geodesics(test::heisenberg_group(grid.target(i)), options);
  }
  void put(long i, const Geodesic& geodesic) {
    FieldPoint point;
    point.p0 = Eigen::Map<const Eigen::VectorXd>(geodesic.p0.data(), 3);
    point.windings = {0};
    long flows = 0;
    ASSERT_TRUE(FieldNewton(problem).solve(grid.target(i), point, flows));
    points.put(i, point);
  }
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(put(0, search(0).geodesics.at(0)));
    ASSERT_NO_FATAL_FAILURE(put(2, search(2).geodesics.at(1)));
  }
  void push(long i) {
    wave.push(points.point(points.best(i)), 0, grid.step(i, 0, i == 0 ? 1 : -1));
  }
};

TEST_F(Between, ReachesWhatWaits) {
  push(2);
  EXPECT_TRUE(wave.awaits(1));
  EXPECT_FALSE(wave.awaits(0));
  EXPECT_FALSE(points.known(1));
  wave.run();
  EXPECT_FALSE(wave.awaits(1));
  ASSERT_TRUE(points.known(1));
  EXPECT_NEAR(points.action(1), search(1).geodesics.at(1).action, 1e-9);
}

TEST_F(Between, KeepsTheLeastOfThoseThatPromise) {
  push(2);
  push(0);
  wave.run();
  ASSERT_TRUE(points.known(1));
  EXPECT_NEAR(points.action(1), search(1).geodesics.at(0).action, 1e-9);
  EXPECT_EQ(counts.improved, 2);
}

TEST_F(Between, AsksAgainOnlyWhereThatPromisesLess) {
  push(0);
  push(2);
  wave.run();
  EXPECT_NEAR(points.action(1), search(1).geodesics.at(0).action, 1e-9);
  EXPECT_EQ(counts.pushes, 1);
}

}  // namespace
}  // namespace carnot::internal::field_wave_test
