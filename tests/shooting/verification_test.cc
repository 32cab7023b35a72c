// Verification, classification and the search for all extremals.
#include "carnot/shooting/extremal/verification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "carnot/make_dynamics.h"
#include "carnot/scenes/kapitza_pendulum.h"
#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/sweep.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/survey.h"
#include "shooting/problems.h"

namespace carnot::internal::verification_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 1e-10;
constexpr long kSteps = 32;
const std::vector<double> kSidewaysP0{
    -5.363131400277701, 16.18437737239682, -9.311614737376091, -4.080757918683527};

TEST(Verification, AcceptsWhatArrives) {
  const BoundaryValueProblem problem = test::sideways();
  const auto extremal =
      verify(problem, knots_of(problem, kSidewaysP0, 8, kSteps), kSteps, kTolerance).extremal;
  ASSERT_TRUE(extremal);
  EXPECT_EQ(extremal->geodesic.verification, Verification::kSingle);
  EXPECT_LE(extremal->geodesic.endpoint_error, kTolerance);
  EXPECT_FALSE(extremal->singular);
  // The error that is reported is that of an integration afresh.
  std::vector<double> z = problem.from;
  z.insert(z.end(), extremal->geodesic.p0.begin(), extremal->geodesic.p0.end());
  ASSERT_TRUE(problem.dynamics.flow(extremal->geodesic.plan, z).completed());
  EXPECT_EQ(largest_difference(z.data(), problem.to.data(), 4), extremal->geodesic.endpoint_error);
}

TEST(Verification, RefusesWhatDoesNotArrive) {
  const BoundaryValueProblem problem = test::sideways();
  const Knots astray = knots_of(problem, {300, -200, 100, 500}, 1, kSteps);
  const Outcome outcome = verify(problem, astray, kSteps, kTolerance);
  EXPECT_FALSE(outcome.extremal);
  EXPECT_GE(outcome.reason, Reason::kFlowFailed);
}

TEST(Verification, AToleranceOutOfReachIsRefused) {
  const BoundaryValueProblem problem = test::sideways();
  const Knots knots = knots_of(problem, kSidewaysP0, 8, kSteps);
  const Outcome outcome = verify(problem, knots, kSteps, 1e-20);
  EXPECT_FALSE(outcome.extremal);
  EXPECT_EQ(outcome.reason, Reason::kBeyondDouble);
}

TEST(Verification, AbnormalExtremalsGetTheCovectorOfLeastNorm) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {0, 0, 0, kPi / 2});
  // Steering in place with some of the abnormal covector (sin theta, -cos theta, length, 0) added.
  const Knots knots = knots_of(problem, {0, -3, 3, kPi / 2}, 1, kSteps);
  auto extremal = verify(problem, knots, kSteps, kTolerance).extremal;
  ASSERT_TRUE(extremal);
  EXPECT_TRUE(extremal->singular);
  EXPECT_NEAR(extremal->geodesic.p0[1], 0, 1e-12);
  EXPECT_NEAR(extremal->geodesic.p0[3], kPi / 2, 1e-12);
  complete(problem, 0, *extremal);
  EXPECT_EQ(extremal->geodesic.abnormal, true);
  EXPECT_EQ(extremal->geodesic.family_dimension, 0);
}

TEST(Verification, AFamilyIsSingular) {
  // Full circles that enclose the area 1: all directions at the start will do.
  const BoundaryValueProblem problem = test::heisenberg_group({0, 0, 1});
  const double speed = 2 * std::sqrt(kPi);
  std::vector<Extremal> members;
  for (const double direction : {0.0, 1.0}) {
    const std::vector<double> p0{speed * std::cos(direction), speed * std::sin(direction), 2 * kPi};
    auto extremal = verify(problem, knots_of(problem, p0, 1, kSteps), kSteps, kTolerance).extremal;
    ASSERT_TRUE(extremal);
    complete(problem, 0, *extremal);
    EXPECT_EQ(extremal->geodesic.label, Label::kSingular);
    EXPECT_EQ(extremal->geodesic.family_dimension, 1);
    EXPECT_EQ(extremal->geodesic.morse_index, 0) << "T is conjugate, but not passed";
    EXPECT_EQ(extremal->geodesic.abnormal, false);
    members.push_back(*extremal);
  }
  EXPECT_FALSE(same(members[0], members[1]));
  EXPECT_TRUE(same_family(members[0], members[1]));
}

TEST(Survey, SamplesAcrossKnotsAreThoseOfOneRun) {
  const BoundaryValueProblem problem = test::sideways();
  const FlowSummary one = survey(problem, knots_of(problem, kSidewaysP0, 1, 64), 64, 21);
  const FlowSummary many = survey(problem, knots_of(problem, kSidewaysP0, 8, 64), 64, 21);
  ASSERT_EQ(one.trajectory.t.size(), 21U);
  ASSERT_EQ(many.trajectory.t.size(), 21U);
  EXPECT_NEAR(one.action, many.action, 1e-11);
  for (std::size_t i = 0; i < 21; ++i) {
    EXPECT_NEAR(one.trajectory.t[i], many.trajectory.t[i], 1e-15);
    for (std::size_t j = 0; j < 4; ++j) {  // a start of each segment afresh: last stages differ
      EXPECT_NEAR(one.trajectory.q[i][j], many.trajectory.q[i][j], 1e-11);
    }
  }
}

// H depends on time: it is that of the knot's own time, and the work goes on from knot to knot.
TEST(Survey, AcrossKnotsTheEnergyIsThatOfOneRun) {
  const BoundaryValueProblem problem(
      make_dynamics(scenes::KapitzaPendulum{1, 1, 0.2, 5}), {0.7}, {0}, 1.7);
  const FlowSummary one = survey(problem, knots_of(problem, {0.4}, 1, 64), 64, 21);
  const FlowSummary many = survey(problem, knots_of(problem, {0.4}, 8, 64), 64, 21);
  ASSERT_EQ(one.trajectory.work.size(), 21U);
  ASSERT_EQ(many.trajectory.work.size(), 21U);
  EXPECT_GT(std::abs(one.work), 0.01);
  EXPECT_NEAR(many.work, one.work, 1e-12);
  for (std::size_t i = 0; i < 21; ++i) {
    const Trajectory& path = many.trajectory;
    EXPECT_NEAR(path.work[i], one.trajectory.work[i], 1e-12);
    EXPECT_NEAR(path.hamiltonian[i] - path.hamiltonian[0], path.work[i], 1e-12);
  }
  // Of many knots the largest drifts within a piece are added to that of its start.
  EXPECT_GE(many.energy_drift, one.energy_drift - 1e-12);
  EXPECT_LE(many.energy_drift, 2 * one.energy_drift);
}

TEST(Sweep, DoesNotDependOnThreads) {
  const BoundaryValueProblem problem = test::sideways();
  SweepOptions options;
  options.flows = 40;
  options.keep = 5;
  options.lowest = 10;
  options.highest = 40;
  options.momentum_scale = {5, 16, 10, 4};
  const std::vector<Path> one = near_hits(problem, options, 1);
  const std::vector<Path> two = near_hits(problem, options, 2);
  ASSERT_EQ(one.size(), 5U);
  ASSERT_EQ(two.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(one[i].q, two[i].q);
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(one[i].configuration(one[i].intervals)[j], problem.to[j]);
    }
  }
}

// Extremals of the Heisenberg group to (x, z) solve mu(w/2) = 4 z / |x|^2 with
// mu(s) = s / sin^2 s - cot s (Gaveau 1977); for (1, 0, 5) that has 11 roots.
TEST(Search, FindsAllOfTheHeisenbergGroup) {
  GeodesicOptions options;
  options.all = true;
  options.samples = 0;
  const GeodesicReport report = find_geodesics(test::heisenberg_group({1, 0, 5}), options);
  EXPECT_EQ(report.geodesics.size(), 11U);
  for (std::size_t i = 0; i < report.geodesics.size(); ++i) {
    const Label expected = i == 0 ? Label::kLocallyMinimal : Label::kConjugatePassed;
    EXPECT_EQ(report.geodesics[i].label, expected) << i;
    const double s = report.geodesics[i].p0[2] / 2;
    const double mu = s / (std::sin(s) * std::sin(s)) - std::cos(s) / std::sin(s);
    EXPECT_NEAR(mu, 20, 1e-6) << i;  // magnified by d mu / d s, up to 1e3
  }
}

TEST(Search, KeepsOneMemberOfAFamily) {
  GeodesicOptions options;
  options.all = true;
  options.samples = 0;
  options.starts = 24;
  const GeodesicReport report = find_geodesics(test::heisenberg_group({0, 0, 1}), options);
  ASSERT_FALSE(report.geodesics.empty());
  EXPECT_NEAR(report.geodesics[0].length.value(), 2 * std::sqrt(kPi), 1e-9);
  for (std::size_t i = 1; i < report.geodesics.size(); ++i) {
    EXPECT_GT(report.geodesics[i].action, report.geodesics[i - 1].action * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace carnot::internal::verification_test
