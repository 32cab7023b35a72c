#include "carnot/shooting/shoot/knots.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/make_dynamics.h"
#include "shooting/problems.h"
#include "testing/failing_scenes.h"

namespace carnot::internal::knots_test {
namespace {

TEST(Knots, AreEveryFewNodesOfAPath) {
  Path path{8, 1, {0, 1, 2, 3, 4, 5, 6, 7, 8}, {}, {10, 11, 12, 13, 14, 15, 16, 17, 18}};
  const Knots knots = knots_of(path, 4);
  EXPECT_EQ(knots.segments, 4);
  EXPECT_EQ(knots.z, (std::vector<double>{0, 10, 2, 12, 4, 14, 6, 16, 8, 18}));
  EXPECT_EQ(knots.p0(), std::vector<double>{10});
}

// q'' = -q from rest at 1: (cos t, -sin t).
TEST(Knots, OfAnExtremalLieOnIt) {
  const BoundaryValueProblem problem = test::oscillator({1, 0}, {0, 0}, 2);
  const Knots knots = knots_of(problem, {0, 0}, 4, 64);
  for (int i = 0; i <= 4; ++i) {
    EXPECT_NEAR(knots.at(i)[0], std::cos(0.5 * i), 1e-13);
    EXPECT_NEAR(knots.at(i)[2], -std::sin(0.5 * i), 1e-13);
  }
}

TEST(Knots, RepeatTheLastWhereTheFlowFails) {
  const BoundaryValueProblem problem(
      make_dynamics(test::OneByOne<test::FadingMass>{}), {1, 0, 0}, {-1, 0, 0});
  const Knots knots = knots_of(problem, {-4, 0, 0}, 4, 16);
  ASSERT_EQ(knots.z.size(), 5U * 6);
  const std::vector<double> last(knots.at(4), knots.at(4) + 6);
  EXPECT_EQ(std::vector<double>(knots.at(3), knots.at(3) + 6), last);
  for (const double x : knots.z) EXPECT_TRUE(std::isfinite(x));
}

TEST(Knots, AreEveryFewSamplesOfATrajectory) {
  Trajectory samples;
  for (int i = 0; i <= 6; ++i) {
    samples.t.push_back(i);
    samples.q.push_back({1.0 * i});
    samples.p.push_back({-1.0 * i});
  }
  EXPECT_EQ(knots_of(samples, 3).z, (std::vector<double>{0, 0, 2, -2, 4, -4, 6, -6}));
}

TEST(Knots, PlansOfSegmentsMeet) {
  const BoundaryValueProblem problem = test::oscillator({1, 0}, {0, 0}, 3);
  for (int i = 0; i < 4; ++i) {
    const StepPlan plan = knot_plan(problem, 4, i, 10);
    EXPECT_EQ(plan.count, 3) << "rounded up";
    const StepPlan whole = StepPlan::equal(0.75 * i, 0.75, 3);
    EXPECT_EQ(plan.start, whole.start);
    EXPECT_EQ(plan.step, whole.step);
  }
  EXPECT_EQ(knot_plan(problem, 4, 0, 0).count, 1);
}

}  // namespace
}  // namespace carnot::internal::knots_test
