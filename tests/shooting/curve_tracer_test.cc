// Steps along a curve: where they begin, where they end, and every way to end early.
#include "carnot/shooting/continue/curve_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::curve_tracer_test {
namespace {

constexpr long kSteps = 32;

// An extremal of the unicycle whose target moves.
struct CurveTracerTest : testing::Test {
  BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  ProblemLine line = moving_target(problem, {2, 1, 1});
  ContinuationOptions options;
  ContinuationReport report;
  Place start{knots_of(problem, find_geodesics(problem).geodesics.at(0).p0, 1, kSteps), 0};
};

TEST_F(CurveTracerTest, ReachesTheEnd) {
  CurveTracer tracer(line, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kReached);
  ASSERT_GE(report.points.size(), 3U);
  EXPECT_EQ(report.points.front().s, 0);
  EXPECT_EQ(report.points.back().s, 1);
  for (std::size_t i = 1; i < report.points.size(); ++i) {
    EXPECT_GT(report.points[i].s, report.points[i - 1].s);
  }
  for (const ContinuationPoint& point : report.points) {
    EXPECT_LE(point.geodesic.endpoint_error, options.tolerance);
    EXPECT_EQ(point.geodesic.label, Label::kLocallyMinimal);
    EXPECT_EQ(point.branch, 0);
  }
  EXPECT_TRUE(tracer.crossings().empty());
}

TEST_F(CurveTracerTest, StepsAreNotLongerThanAllowed) {
  options.largest_step = options.first_step = 0.01;
  options.labels = false;
  CurveTracer tracer(line, options, kSteps, 3, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kReached);
  EXPECT_EQ(report.points.back().branch, 3);
  for (std::size_t i = 1; i < report.points.size(); ++i) {
    // A step at the end may be a tenth longer, and arclength is longer than s.
    EXPECT_LE(report.points[i].s - report.points[i - 1].s, 0.011 + 1e-4);
  }
}

TEST_F(CurveTracerTest, StopsAtTheLargestNumberOfPoints) {
  options.max_points = 3;
  CurveTracer tracer(line, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kMaxPoints);
  EXPECT_EQ(report.points.size(), 3U);
}

TEST_F(CurveTracerTest, StopsWhenItIsTold) {
  options.progress = [](double) { return false; };
  CurveTracer tracer(line, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kInterrupted);
  EXPECT_EQ(report.points.size(), 1U);
}

TEST_F(CurveTracerTest, RefusesAStartThatIsNoExtremal) {
  start.knots = knots_of(problem, {300, -200, 100}, 1, kSteps);
  CurveTracer tracer(line, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kNotConverged);
  EXPECT_TRUE(report.points.empty());
}

TEST_F(CurveTracerTest, RefusesAnAbnormalStart) {
  const BoundaryValueProblem steering = test::vehicle({0, 0, 0, 0}, {0, 0, 0, 1});
  const ProblemLine further = moving_target(steering, {0, 0, 0, 2});
  CurveTracer tracer(further, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace({knots_of(steering, {0, 0, 0, 1}, 1, kSteps), 0}),
            ContinuationStatus::kSingular);
}

// No flow verifies a point to 1e-300.
TEST_F(CurveTracerTest, RefusesAToleranceOutOfReach) {
  options.tolerance = 1e-300;
  CurveTracer tracer(line, options, kSteps, 0, report);
  EXPECT_EQ(tracer.trace(start), ContinuationStatus::kNotConverged);
}

}  // namespace
}  // namespace carnot::internal::curve_tracer_test
