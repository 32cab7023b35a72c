// Continuation where there are limits: against searches, where arcs begin, and where it must end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/continuation.h"
#include "carnot/shooting/find_geodesics.h"
#include "shooting/drift_problems.h"
#include "shooting/problems.h"

namespace carnot::limited_continuation_test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kViolation = 1e-10;
// Two routes to one extremal, each to the tolerance of its end points.
constexpr double kSameAction = 1e-9;

Dynamics program_scene(const std::string& name, const std::string& lines) {
  const std::string path = CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + name + ".scene";
  return test::from_text(load_scene(path).text() + "\n" + lines);
}

// Sideways parking with |phi - theta| <= bound.
BoundaryValueProblem parking(double bound) {
  BoundaryValueProblem problem(
      program_scene("vehicle", "limit -1 < phi - theta < 1 \"steering\"\n"),
      {0, 0, 0, 0},
      {0, 1, 0, 0});
  problem.limits[0].lower = -bound;
  problem.limits[0].upper = bound;
  return problem;
}

ProblemLine tightened(const BoundaryValueProblem& problem, double bound) {
  return {[=](double s) {
    BoundaryValueProblem changed = problem;
    Limit& limit = changed.limits[0];
    limit.upper = (1 - s) * problem.limits[0].upper + s * bound;
    limit.lower = -limit.upper;
    return changed;
  }};
}

Geodesic start_of(const ProblemLine& line) {
  GeodesicOptions options;
  options.samples = 257;
  const GeodesicReport report = find_geodesics(line.at(0), options);
  EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  return report.geodesics.empty() ? Geodesic{} : report.geodesics.front();
}

TEST(LimitedContinuation, FollowsArcsAsTheyAppear) {
  constexpr double kLoose = 0.6;
  constexpr double kTight = 0.3;
  const ProblemLine line = tightened(parking(kLoose), kTight);
  const Geodesic start = start_of(line);
  const ContinuationReport report = continue_geodesic(line, start);
  ASSERT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  double before = 0;
  for (const ContinuationPoint& point : report.points) {
    EXPECT_LE(point.geodesic.limit_violation, kViolation);
    EXPECT_EQ(point.geodesic.label, Label::kLocallyMinimal);
    // A tighter limit costs more.
    EXPECT_GE(point.geodesic.action, before * (1 - kSameAction));
    before = point.geodesic.action;
  }
  // As a direct method and the exact arcs of an earlier program agree on it.
  EXPECT_NEAR(before, 23.275244006, kSameAction * before);
  const std::vector<std::pair<double, double>>& arcs =
      report.points.back().geodesic.limits[0].active;
  EXPECT_EQ(arcs.size(), 4U);

  // The four arcs come one by one, the first where the geodesic without limits turns most.
  ASSERT_EQ(report.contact_changes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const ContactChange& change = report.contact_changes[i];
    EXPECT_EQ(change.before.size(), i);
    EXPECT_EQ(change.after, std::vector<std::string>(i + 1, "steering"));
    EXPECT_LE(change.error, 1e-6);
  }
  GeodesicOptions dense;
  dense.samples = 16385;
  BoundaryValueProblem free = parking(kLoose);
  free.limits.clear();
  double largest = 0;
  const GeodesicReport unlimited = find_geodesics(free, dense);
  for (const auto& q : unlimited.geodesics.at(0).trajectory.q) {
    largest = std::max(largest, std::abs(q[3] - q[2]));
  }
  const double s = report.contact_changes[0].s;
  // The change is located to 1e-6 of the line.
  EXPECT_NEAR((1 - s) * kLoose + s * kTight, largest, 1e-6);
}

TEST(LimitedContinuation, AgreesWithSearches) {
  const ProblemLine line = tightened(parking(0.35), 0.25);
  const ContinuationReport report = continue_geodesic(line, start_of(line));
  ASSERT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  for (const std::size_t i : {report.points.size() / 2, report.points.size() - 1}) {
    const GeodesicReport found = find_geodesics(line.at(report.points[i].s));
    ASSERT_FALSE(found.geodesics.empty());
    const double action = report.points[i].geodesic.action;
    EXPECT_NEAR(found.geodesics[0].action, action, kSameAction * action);
  }
}

// Where a limit is never met it changes nothing.
TEST(LimitedContinuation, IsThatWithoutLimitsWhereTheyAreLoose) {
  const BoundaryValueProblem loose = parking(1.2);
  BoundaryValueProblem free = loose;
  free.limits.clear();
  const std::vector<double> to{0, 0.8, 0, 0};
  const ProblemLine line = moving_target(loose, to);
  const ContinuationReport report = continue_geodesic(line, start_of(line));
  const ContinuationReport other =
      continue_geodesic(moving_target(free, to), start_of(moving_target(free, to)));
  ASSERT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  ASSERT_EQ(other.status, ContinuationStatus::kReached) << other.message;
  EXPECT_THAT(report.contact_changes, IsEmpty());
  EXPECT_NEAR(report.points.back().geodesic.action,
              other.points.back().geodesic.action,
              kSameAction * report.points.back().geodesic.action);
}

// Beyond a fold there is nothing to go on to; other extremals are not far.
TEST(LimitedContinuation, EndsWhereTheBranchTurns) {
  const BoundaryValueProblem loose = parking(1.2);
  BoundaryValueProblem free = loose;
  free.limits.clear();
  const std::vector<double> to{0.3, 1.2, 0.1, 0};
  const ProblemLine line = moving_target(loose, to);
  const ContinuationReport report = continue_geodesic(line, start_of(line));
  EXPECT_EQ(report.status, ContinuationStatus::kStepTooSmall);
  EXPECT_THAT(report.message, HasSubstr("branch"));
  const ContinuationReport turned =
      continue_geodesic(moving_target(free, to), start_of(moving_target(free, to)));
  ASSERT_EQ(turned.folds.size(), 1U);
  EXPECT_NEAR(report.points.back().s, turned.folds[0].s, 1e-4);
  EXPECT_LE(report.points.back().s, turned.folds[0].s);
  EXPECT_NEAR(report.points.back().geodesic.action, turned.folds[0].action, 1e-3);
}

// The extremal of a trailer that is moved sideways ceases to be a minimum before its hinge is at
// 0.6, with another extremal near by. It is followed on, and the label says so.
TEST(LimitedContinuation, StaysOnItsBranch) {
  const BoundaryValueProblem problem(
      program_scene("trailer1", "limit -0.75 < t0 - t1 < 0.75 \"hinge\"\n"),
      {0, 0, 0, 0},
      {0, 1, 0, 0});
  const ProblemLine line = tightened(problem, 0.6);
  const ContinuationReport report = continue_geodesic(line, start_of(line));
  ASSERT_EQ(report.status, ContinuationStatus::kReached) << report.message;
  EXPECT_THAT(report.contact_changes, IsEmpty());
  EXPECT_EQ(report.points.front().geodesic.label, Label::kLocallyMinimal);
  EXPECT_EQ(report.points.back().geodesic.label, Label::kUnknown);
  for (std::size_t i = 1; i < report.points.size(); ++i) {
    const Geodesic& before = report.points[i - 1].geodesic;
    const Geodesic& here = report.points[i].geodesic;
    EXPECT_LE(here.knot_defect, 1e-10);
    EXPECT_GT(here.action, before.action);
    // The arc grows on both sides.
    EXPECT_LT(here.limits[0].active[0].first, before.limits[0].active[0].first);
    EXPECT_GT(here.limits[0].active[0].second, before.limits[0].active[0].second);
  }
}

TEST(LimitedContinuation, NamesTheLimitThatAnEndMeets) {
  const BoundaryValueProblem problem = parking(0.5);
  const ProblemLine line = moving_target(problem, {0, 1, 0, 0.8});
  ContinuationOptions options;
  options.smallest_step = 1e-3;
  const ContinuationReport report = continue_geodesic(line, start_of(line), options);
  EXPECT_EQ(report.status, ContinuationStatus::kStepTooSmall);
  EXPECT_THAT(report.message, HasSubstr("the target is beyond the limit 'steering'"));
  // phi - theta of the target is 0.8 s.
  EXPECT_NEAR(report.points.back().s, 0.5 / 0.8, 2 * options.smallest_step);
}

TEST(LimitedContinuation, CanBeStoppedAndRefused) {
  const ProblemLine line = tightened(parking(0.5), 0.4);
  const Geodesic start = start_of(line);
  ContinuationOptions options;
  options.max_points = 3;
  EXPECT_EQ(continue_geodesic(line, start, options).status, ContinuationStatus::kMaxPoints);
  options.progress = [](double fraction) { return fraction < 0.03; };
  options.max_points = 1000;
  EXPECT_EQ(continue_geodesic(line, start, options).status, ContinuationStatus::kInterrupted);
  Geodesic unsampled = start;
  unsampled.trajectory = {};
  EXPECT_THROW(continue_geodesic(line, unsampled), std::invalid_argument);
  // Something else than an extremal of the problem.
  Geodesic wrong = start;
  wrong.action *= 1.1;
  EXPECT_EQ(continue_geodesic(line, wrong).status, ContinuationStatus::kNotConverged);
}

}  // namespace
}  // namespace carnot::limited_continuation_test
