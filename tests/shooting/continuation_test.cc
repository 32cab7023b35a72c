// Continuation against closed forms, against itself backwards, and against solving anew.
#include "carnot/shooting/continuation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::continuation_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-10;  // of every point at its end,
constexpr double kMagnified = 1e-8;   // and what conditioning makes of it in p0
// Of a branch point: Newton's method stops as near to one as the singular Jacobian lets it.
constexpr double kBranchPoint = 1e-10;

Geodesic geodesic_of(const BoundaryValueProblem& problem, int rank = 1) {
  GeodesicOptions options;
  options.count = rank;
  options.samples = 129;
  return find_geodesics(problem, options).geodesics.at(rank - 1);
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t j = 0; j < a.size(); ++j) EXPECT_NEAR(a[j], b[j], tolerance) << j;
}

void expect_verified(const ContinuationReport& report) {
  for (const ContinuationPoint& point : report.points) {
    EXPECT_LE(point.geodesic.endpoint_error, kTolerance);
    EXPECT_LE(point.geodesic.knot_defect, kTolerance);
  }
}

// Gaveau 1977: with s = p_z / 2 and T = 1, extremals of the Heisenberg group to (x, y, z) solve
// mu(s) |x|^2 = 4 z, mu = s / sin^2 s - cot s, and the action is |x|^2 s^2 / (2 sin^2 s). mu' = 0
// where tan s = s, and there mu = s.
TEST(Continuation, PassesTheFoldOfTheHeisenbergGroup) {
  constexpr double kFold = 4.493409457909064;  // tan s = s
  const BoundaryValueProblem problem = test::heisenberg_group({0.5, 0, 0.5});
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {0.5, 0, 0}), geodesic_of(problem, 2));
  EXPECT_EQ(report.status, ContinuationStatus::kReturned);
  EXPECT_TRUE(report.complete());
  expect_verified(report);
  ASSERT_EQ(report.folds.size(), 1U);
  EXPECT_TRUE(report.branch_points.empty());
  EXPECT_NEAR(report.folds[0].s, 1 - 0.125 * kFold, 1e-12);
  EXPECT_NEAR(report.folds[0].p0[2], 2 * kFold, kMagnified);
  int changes = 0;
  for (std::size_t i = 0; i < report.points.size(); ++i) {
    const Geodesic& geodesic = report.points[i].geodesic;
    const double s = 0.5 * geodesic.p0[2];
    const double sine = std::sin(s);
    EXPECT_NEAR(s / (sine * sine) - std::cos(s) / sine, 8 * (1 - report.points[i].s), kMagnified);
    EXPECT_NEAR(geodesic.action, 0.125 * s * s / (sine * sine), kMagnified);
    if (i == 0) continue;
    const bool changed =
        geodesic.morse_index.value() != report.points[i - 1].geodesic.morse_index.value();
    changes += changed ? 1 : 0;
    if (changed) {
      EXPECT_GE(geodesic.p0[2], 2 * kFold);
    }
  }
  EXPECT_EQ(changes, 1);
  EXPECT_GT(report.points.back().geodesic.p0[2], 2 * kFold);
}

TEST(Continuation, ThereAndBackIsTheSameGeodesic) {
  BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  const std::vector<double> target{2, 1, 1};
  const Geodesic start = geodesic_of(problem);
  const ContinuationReport there = continue_geodesic(moving_target(problem, target), start);
  ASSERT_EQ(there.status, ContinuationStatus::kReached);
  EXPECT_EQ(there.message, "");
  EXPECT_EQ(there.points.back().s, 1);
  problem.to = target;
  const ContinuationReport back =
      continue_geodesic(moving_target(problem, {1, 1, 0}), there.points.back().geodesic);
  ASSERT_EQ(back.status, ContinuationStatus::kReached);
  expect_near(back.points.back().geodesic.p0, start.p0, kMagnified);
}

// With V = 0 the path does not depend on T, and p is inversely proportional to it.
TEST(Continuation, InTimeScalesTheMomentum) {
  const BoundaryValueProblem problem = test::sideways();
  const Geodesic start = geodesic_of(problem);
  const ContinuationReport report = continue_geodesic(moving_time(problem, 3), start);
  ASSERT_EQ(report.status, ContinuationStatus::kReached);
  expect_verified(report);
  for (const ContinuationPoint& point : report.points) {
    const double time = 1 + 2 * point.s;
    EXPECT_NEAR(point.geodesic.action, start.action / time, kMagnified);
    for (int j = 0; j < 4; ++j) {
      EXPECT_NEAR(point.geodesic.p0[j], start.p0[j] / time, kMagnified);
    }
  }
}

// Moving the start by -d, or the target by d: translations are symmetries.
TEST(Continuation, StartAndTargetMoveAlike) {
  const BoundaryValueProblem problem = test::unicycle({2e6, 1, 0}, {2e6, 2, 0});
  const Geodesic start = geodesic_of(problem);
  const ContinuationReport a = continue_geodesic(moving_target(problem, {2e6 + 1, 2.5, 0}), start);
  const ContinuationReport b = continue_geodesic(moving_start(problem, {2e6 - 1, 0.5, 0}), start);
  ASSERT_EQ(a.status, ContinuationStatus::kReached);
  ASSERT_EQ(b.status, ContinuationStatus::kReached);
  expect_near(a.points.back().geodesic.p0, b.points.back().geodesic.p0, kMagnified);
}

TEST(Continuation, InAParameterArrivesWhereSolvingAnewDoes) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5});
  const ProblemLine line{[&](double s) {
    BoundaryValueProblem changed = problem;
    changed.dynamics = test::vehicle_with_alpha(1 - 0.9 * s);
    return changed;
  }};
  const ContinuationReport report = continue_geodesic(line, geodesic_of(problem));
  ASSERT_EQ(report.status, ContinuationStatus::kReached);
  expect_verified(report);
  expect_near(report.points.back().geodesic.p0, geodesic_of(line.at(1)).p0, kMagnified);
}

// A pendulum at rest is stationary for every T; from T = pi on it may also swing out and back, in
// half a period 2 K(k) with p(0) = 2 k to either side.
TEST(Continuation, FollowsBothArmsOfAPitchfork) {
  const BoundaryValueProblem problem = test::pendulum(0, 0, 2);
  Geodesic rest;
  rest.p0 = {0};
  ContinuationOptions options;
  options.branches = true;
  const ContinuationReport report = continue_geodesic(moving_time(problem, 5), rest, options);
  ASSERT_EQ(report.status, ContinuationStatus::kReached);
  EXPECT_TRUE(report.folds.empty());
  ASSERT_EQ(report.branch_points.size(), 1U);
  EXPECT_NEAR(2 + 3 * report.branch_points[0].s, kPi, kBranchPoint);
  ASSERT_EQ(report.branch_ends.size(), 2U);
  double product = 1;
  for (const ContinuationPoint& point : report.points) {
    const double p0 = point.geodesic.p0[0];
    const double time = 2 + 3 * point.s;
    EXPECT_EQ(point.geodesic.morse_index, point.branch == 0 && time > kPi ? 1 : 0);
    if (point.branch == 0) {
      EXPECT_EQ(p0, 0);
    } else {
      EXPECT_NEAR(2 * std::comp_ellint_1(0.5 * p0), time, kMagnified);
    }
    if (point.branch > 0 && point.s == 1) product *= p0;
  }
  EXPECT_LT(product, 0);
  for (const ContinuationStatus end : report.branch_ends) {
    EXPECT_EQ(end, ContinuationStatus::kReached);
  }
}

// All circles through (0, 0, 1) go there: a continuum, which the extremals to (x, 0, 1) cross.
// Two equal springs from q0 to -q0 + (T - pi) w: p0 = (to - q0 cos T) / sin T is smooth, -w at
// T = pi. There any p0 leads to -q0: the Jacobian lacks two in rank, its determinant touches zero.
TEST(Continuation, ReportsBranchPointsOfEvenMultiplicity) {
  const auto target = [](double time) {
    return std::vector<double>{-1 + 0.3 * (time - kPi), 0.5 * (time - kPi)};
  };
  const auto time_at = [](double s) { return 2 + 3 * s; };
  const ProblemLine line{[&](double s) {
    return test::oscillator({1, 0}, target(time_at(s)), time_at(s));
  }};
  const ContinuationReport report = continue_geodesic(line, geodesic_of(line.at(0)));
  EXPECT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  expect_verified(report);
  for (const ContinuationPoint& point : report.points) {
    const double time = time_at(point.s);
    const double p0 = (target(time)[0] - std::cos(time)) / std::sin(time);
    EXPECT_NEAR(point.geodesic.p0[0], p0, kMagnified);
    EXPECT_EQ(point.geodesic.morse_index, time < kPi ? 0 : 2);
  }
  ASSERT_EQ(report.branch_points.size(), 1U);
  EXPECT_NEAR(time_at(report.branch_points[0].s), kPi, kBranchPoint);
  EXPECT_TRUE(report.folds.empty());
}

// A pendulum that stands still on the way: p0 passes zero.
TEST(Continuation, TheMomentumMayVanish) {
  const BoundaryValueProblem problem = test::oscillator({1, 0}, {-1, 0}, 2);
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {0.5, 0}), geodesic_of(problem));
  EXPECT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  const auto p0 = [](const ContinuationPoint& point) { return point.geodesic.p0[0]; };
  EXPECT_LT(p0(report.points.front()), 0);
  EXPECT_GT(p0(report.points.back()), 0);
}

TEST(Continuation, AFamilyIsAClosedCurveWithBranchPoints) {
  const BoundaryValueProblem problem = test::heisenberg_group({0, 0, 1});
  const double speed = 2 * std::sqrt(kPi);
  Geodesic start;
  start.p0 = {speed * std::cos(1), speed * std::sin(1), 2 * kPi};
  ContinuationOptions options;
  options.labels = false;
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {0.5, 0, 1}), start, options);
  EXPECT_EQ(report.status, ContinuationStatus::kClosed);
  EXPECT_TRUE(report.folds.empty());
  ASSERT_EQ(report.branch_points.size(), 2U);
  for (const SpecialPoint& point : report.branch_points) {
    EXPECT_NEAR(std::abs(point.p0[0]), speed, 1e-6);
    EXPECT_NEAR(point.p0[1], 0, 1e-6);
    EXPECT_NEAR(point.action, 2 * kPi, 1e-6);
  }
}

TEST(Continuation, KeepsItsDigitsWhereTheFlowGrows) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {4, 1, 0, 0});
  ContinuationOptions options;
  options.labels = false;
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {22, 1, 0, 0}), geodesic_of(problem), options);
  ASSERT_EQ(report.status, ContinuationStatus::kReached);
  expect_verified(report);
  const ContinuationPoint& last = report.points.back();
  EXPECT_EQ(last.geodesic.verification, Verification::kKnots);
  EXPECT_NEAR(last.geodesic.action,
              geodesic_of(test::vehicle({0, 0, 0, 0}, {22, 1, 0, 0})).action,
              kTolerance * last.geodesic.action);
}

TEST(Continuation, StartsFromKnots) {
  const BoundaryValueProblem problem = test::vehicle({5, 0, 0, 0}, {27, 1, 0, 0});
  const Geodesic start = geodesic_of(problem);
  ASSERT_EQ(start.verification, Verification::kKnots);
  ContinuationOptions options;
  options.labels = false;
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {26, 1.5, 0, 0}), start, options);
  EXPECT_EQ(report.status, ContinuationStatus::kReached);
  expect_verified(report);
}

TEST(Continuation, SaysWhyItEnds) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 1, 0});
  const ProblemLine line = moving_target(problem, {0, 3, 0});
  const Geodesic start = geodesic_of(problem);
  ContinuationOptions options;
  options.max_points = 3;
  const ContinuationReport few = continue_geodesic(line, start, options);
  EXPECT_EQ(few.status, ContinuationStatus::kMaxPoints);
  EXPECT_EQ(few.points.size(), 3U);
  EXPECT_FALSE(few.complete());
  EXPECT_NE(few.message.find("more of them"), std::string::npos);
  options.progress = [](double) { return false; };
  EXPECT_EQ(continue_geodesic(line, start, options).status, ContinuationStatus::kInterrupted);

  Geodesic astray;
  astray.p0 = {300, -200, 100};
  const ContinuationReport none = continue_geodesic(line, astray);
  EXPECT_EQ(none.status, ContinuationStatus::kNotConverged);
  EXPECT_TRUE(none.points.empty());
  EXPECT_FALSE(none.message.empty());
}

TEST(Continuation, AnAbnormalStartIsSingular) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {0, 0, 0, 1});
  Geodesic steering;
  steering.p0 = {0, 0, 0, 1};
  const ContinuationReport report =
      continue_geodesic(moving_target(problem, {0, 0, 0, 2}), steering);
  EXPECT_EQ(report.status, ContinuationStatus::kSingular);
  EXPECT_TRUE(report.points.empty());
  EXPECT_FALSE(report.message.empty());
}

TEST(Continuation, BadInputIsRefused) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 1, 0});
  const ProblemLine line = moving_target(problem, {0, 3, 0});
  Geodesic start;
  start.p0 = {1, 2};
  EXPECT_THROW(continue_geodesic(line, start), std::invalid_argument);
  start.p0 = {1, 2, 3};
  start.verification = Verification::kKnots;  // without samples
  EXPECT_THROW(continue_geodesic(line, start), std::invalid_argument);
  EXPECT_THROW(continue_geodesic(moving_time(problem, -1), start), std::invalid_argument);
  ContinuationOptions options;
  options.max_points = 0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options = {};
  options.smallest_step = 0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options = {};
  options.largest_step = 1e-3;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options = {};
  options.tolerance = 0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::continuation_test
