// Every way for a search to find nothing has its code.
#include "carnot/shooting/search/failure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/polish.h"
#include "shooting/problems.h"
#include "testing/failing_scenes.h"

namespace carnot::internal::failure_test {
namespace {

constexpr long kSteps = 32;
const std::vector<double> kSidewaysP0{
    -5.363131400277701, 16.18437737239682, -9.311614737376091, -4.080757918683527};

// The code of a search, and whether the report is one of a failure.
Reason reason_of(const BoundaryValueProblem& problem, const GeodesicOptions& options) {
  const GeodesicReport report = find_geodesics(problem, options);
  EXPECT_TRUE(report.geodesics.empty());
  EXPECT_NE(report.status, GeodesicStatus::kConverged);
  EXPECT_FALSE(report.message.empty());
  return report.reason;
}

Path straight_path(const BoundaryValueProblem& problem, int intervals) {
  Path path;
  path.intervals = intervals;
  path.dof = problem.dynamics.dof;
  path.lambda.assign(static_cast<std::size_t>(intervals) * problem.dynamics.transcribed, 0.0);
  for (int i = 0; i <= intervals; ++i) {
    for (int j = 0; j < path.dof; ++j) {
      path.q.push_back(problem.from[j] + i * (problem.to[j] - problem.from[j]) / intervals);
    }
  }
  fill_momenta(problem.dynamics, problem.time / intervals, path);
  return path;
}

TEST(Failure, ThereIsNoneWhereThereIsAGeodesic) {
  EXPECT_EQ(find_geodesics(test::straight_ahead()).reason, Reason::kNone);
}

TEST(Failure, Interrupted) {
  GeodesicOptions options;
  options.progress = [](double) { return false; };
  EXPECT_EQ(reason_of(test::sideways(), options), Reason::kInterrupted);
}

TEST(Failure, NoStartConverged) {
  GeodesicOptions options;
  options.starts = 1;  // the straight line, which collapses
  EXPECT_EQ(reason_of(test::sideways(), options), Reason::kNoStartConverged);
}

// The turns of both wheels tell the heading of a robot with differential drive, which is
// c/b (right - left) from the start on.
TEST(Failure, TellsWhatTheConstraintsKeep) {
  const Dynamics robot = make_dynamics(scene_from_text(R"(
    coordinates x, y [length], theta, left, right [angle]
    parameters b = 0.5 [length] > 0, c = 0.1 [length] > 0
    kinetic = (x'^2 + y'^2 + 0.05 theta'^2 + 0.01 left'^2 + 0.01 right'^2) / 2
    0 = x' sin(theta) - y' cos(theta)
    0 = x' cos(theta) + y' sin(theta) - c (left' + right') / 2
    0 = b theta' - c (right' - left')
  )"));
  GeodesicOptions options;
  options.starts = 16;
  const GeodesicReport apart =
      find_geodesics({robot, {0, 0, 0, 0, 0}, {0.5, 0.2, 0.4, 4, 6.5}}, options);
  EXPECT_EQ(apart.reason, Reason::kNoStartConverged);
  EXPECT_THAT(apart.message,
              testing::AllOf(testing::HasSubstr("span no more than 4 of 5 directions"),
                             testing::HasSubstr("the derivatives (0, 0, 1, 0.2, -0.2) at")));
  // Where a search finds nothing for other reasons, nothing is said of that.
  options.starts = 1;
  EXPECT_THAT(find_geodesics(test::sideways(), options).message,
              testing::Not(testing::HasSubstr("directions")));
}

// One start on a coarse grid, with a mass that asks for a grid of some 1e5 intervals.
TEST(Failure, TellsOfMassesThatAreTooLight) {
  GeodesicOptions options;
  options.starts = 1;
  const GeodesicReport report =
      find_geodesics(test::light_steering({1, 1, 0.5, 0.2}, 1e-9), options);
  EXPECT_TRUE(report.geodesics.empty());
  EXPECT_THAT(report.message,
              testing::AllOf(testing::HasSubstr("none when it was taken away again"),
                             testing::HasSubstr("try more mass for the lightest coordinate")));
}

// Near the steering angle pi/2 the bicycle turns on the spot for nothing: paths run into it.
TEST(Failure, SingularCoordinates) {
  const BoundaryValueProblem problem = test::bicycle({-0.5, 0.5, 1.5, 1.4});
  EXPECT_EQ(reason_of(problem, {}), Reason::kSingularCoordinates);
}

TEST(Failure, GuessFailed) {
  GeodesicOptions options;
  options.guess = {1e8, 1e8, -1e8, 1e8};
  EXPECT_EQ(reason_of(test::sideways(), options), Reason::kGuessFailed);
}

TEST(Failure, TooLong) {
  GeodesicOptions options;
  options.max_length = 2;
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(reason_of(problem, options), Reason::kTooLong);
  options.guess = find_geodesics(problem).geodesics.at(0).p0;
  EXPECT_EQ(reason_of(problem, options), Reason::kTooLong);
}

// A discrete extremal without a finer one: a path that is nowhere.
TEST(Failure, NotRefined) {
  const BoundaryValueProblem problem = test::sideways();
  Path path = straight_path(problem, 8);
  path.q[path.dof + 1] = std::nan("");
  const Outcome outcome = polish(MassLadder(problem), {}, path);
  EXPECT_FALSE(outcome.extremal);
  EXPECT_EQ(outcome.reason, Reason::kNotRefined);
}

// The straight line is a discrete extremal, but leads where the mass is negative.
TEST(Failure, FlowFailed) {
  const BoundaryValueProblem problem(
      make_dynamics(test::OneByOne<test::FadingMass>{}), {1, 0, 0}, {-1, 0, 0});
  const Outcome outcome = polish(MassLadder(problem), {}, straight_path(problem, 32));
  EXPECT_FALSE(outcome.extremal);
  EXPECT_EQ(outcome.reason, Reason::kFlowFailed);
}

TEST(Failure, NotJoined) {
  const BoundaryValueProblem problem = test::sideways();
  const Knots astray = knots_of(problem, {300, -200, 100, 500}, 1, kSteps);
  const Outcome outcome = polish(problem, {}, astray);
  EXPECT_FALSE(outcome.extremal);
  EXPECT_EQ(outcome.reason, Reason::kNotJoined);
}

// The midpoint rule does not reach the tolerance with the steps that verification affords. Some
// twenty starts say so, not a thousand. It does reach a larger one.
TEST(Failure, MethodTooCoarse) {
  constexpr int kFew = 40;
  const BoundaryValueProblem problem(test::vehicle_midpoint(), {0, 0, 0, 0}, {0, 1, 0, 0});
  GeodesicOptions options;
  const GeodesicReport report = find_geodesics(problem, options);
  EXPECT_EQ(report.reason, Reason::kMethodTooCoarse);
  EXPECT_NE(report.message.find("higher order"), std::string::npos) << report.message;
  EXPECT_LE(report.starts, kFew);
  options.guess = kSidewaysP0;
  EXPECT_EQ(reason_of(problem, options), Reason::kMethodTooCoarse);
  options = {};
  options.tolerance = 1e-4;
  EXPECT_EQ(find_geodesics(problem, options).status, GeodesicStatus::kConverged);
}

// The same where momenta are drawn: some lead to extremals that round-off keeps from their ends.
TEST(Failure, MethodTooCoarseOnAManifold) {
  constexpr int kFew = 64;
  const BoundaryValueProblem problem{test::rod_skate_rattle(), {0, 0, 1, 0}, {1, 0.2, 2, 0.2}};
  const GeodesicReport report = find_geodesics(problem);
  EXPECT_EQ(report.reason, Reason::kMethodTooCoarse);
  EXPECT_NE(report.message.find("higher order"), std::string::npos) << report.message;
  EXPECT_LE(report.starts, kFew);
}

// Round-off is larger than the tolerance; or leaves no digit of the momentum.
TEST(Failure, BeyondDouble) {
  GeodesicOptions options;
  options.tolerance = 1e-22;
  EXPECT_EQ(reason_of(test::sideways(), options), Reason::kBeyondDouble);
  options.guess = kSidewaysP0;
  EXPECT_EQ(reason_of(test::sideways(), options), Reason::kBeyondDouble);
  options = {};
  const BoundaryValueProblem near = test::vehicle({0, 0, 0, 0}, {0, 1e-16, 0, 0});
  EXPECT_EQ(reason_of(near, options), Reason::kBeyondDouble);
}

// A wheel that turns 1e9 rad in place is singular, whatever the digits: steps are too long for it.
// Up to 1e7 rad the answer is found, and at 1e8 a flow arrives, whose round-off is too large.
TEST(Failure, SingularIsNotBeyondDouble) {
  EXPECT_FALSE(find_geodesics(test::vehicle({0, 0, 0, 0}, {0, 0, 0, 1e7}), {}).geodesics.empty());
  const BoundaryValueProblem fast = test::vehicle({0, 0, 0, 0}, {0, 0, 0, 1e9});
  EXPECT_EQ(reason_of(fast, {}), Reason::kFlowFailed);
}

TEST(Failure, NamesDiffer) {
  std::set<std::string> names;
  const auto last = static_cast<int>(Reason::kOnlyAbnormal);
  for (int i = 0; i <= last; ++i) names.insert(name_of(static_cast<Reason>(i)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(last + 1));
}

}  // namespace
}  // namespace carnot::internal::failure_test
