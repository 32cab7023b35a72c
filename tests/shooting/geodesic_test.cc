// Geodesics without a guess: known answers, one route against another, every failure path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/problem/origin.h"
#include "carnot/shooting/problem/problem_line.h"
#include "shooting/problems.h"

namespace carnot::geodesic_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kSideways = 22.7078818037714815;  // least action, 25 digits known
constexpr double kRelative = 1e-11;  // endpoint error times |p| relative to the action, with margin

GeodesicReport find(const BoundaryValueProblem& problem, GeodesicOptions options = {}) {
  return find_geodesics(problem, options);
}

// What the seeds from `first` to `last` find. All of them have to converge.
std::vector<GeodesicReport> of_seeds(const BoundaryValueProblem& problem, int first, int last) {
  std::vector<GeodesicReport> reports;
  for (int seed = first; seed <= last; ++seed) {
    GeodesicOptions options;
    options.seed = seed;
    GeodesicReport report = find_geodesics(problem, options);
    EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
    if (!report.geodesics.empty()) reports.push_back(std::move(report));
  }
  return reports;
}

// How many of them have an action below this one.
long below(double action, const std::vector<GeodesicReport>& reports) {
  return std::count_if(reports.begin(), reports.end(), [&](const GeodesicReport& report) {
    return report.geodesics[0].action < action;
  });
}

TEST(Geodesic, SidewaysParkingForEverySeed) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    GeodesicOptions options;
    options.seed = seed;
    const GeodesicReport report = find(test::sideways(), options);
    ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
    ASSERT_EQ(report.geodesics.size(), 1U);
    const Geodesic& geodesic = report.geodesics[0];
    EXPECT_NEAR(geodesic.action, kSideways, kRelative * kSideways);
    EXPECT_NEAR(geodesic.length.value(), std::sqrt(2 * kSideways), 1e-10);
    EXPECT_EQ(geodesic.verification, Verification::kSingle);
    EXPECT_LE(geodesic.endpoint_error, 1e-10);
    EXPECT_LE(geodesic.constraint_error, 1e-13);
    EXPECT_EQ(geodesic.label, Label::kLocallyMinimal);
    EXPECT_EQ(geodesic.trajectory.t.size(), 201U);
    ASSERT_EQ(geodesic.extremes.size(), 1U);
    EXPECT_EQ(geodesic.extremes[0].first, "largest_steering_angle");
    EXPECT_NEAR(geodesic.extremes[0].second, 0.4572, 1e-3);
  }
}

TEST(Geodesic, ExtremesAreThoseBetweenSamples) {
  // Of 200001 samples the largest is less than the extreme by a bend of some hundreds times the
  // square of 1 / 200000, over 8, and the interpolation is off by as much.
  constexpr double kBetween = 1e-9;
  const std::vector<std::vector<double>> targets{
      {0, 1, 0, 0}, {0, 0.2, 0, 0}, {1, 2, 1, 1}, {-2, 1, 0.5, 2.5}};
  for (const std::vector<double>& to : targets) {
    GeodesicOptions options;
    options.samples = 200001;
    const Geodesic geodesic = find(test::vehicle({0, 0, 0, 0}, to), options).geodesics.at(0);
    double largest = 0;
    for (const auto& q : geodesic.trajectory.q) largest = std::max(largest, std::abs(q[3] - q[2]));
    EXPECT_NEAR(geodesic.extremes.at(0).second, largest, kBetween);
  }
}

TEST(Geodesic, TheAnswerDoesNotDependOnThreads) {
  std::vector<GeodesicReport> reports;
  for (const int threads : {1, 2, 3}) {
    GeodesicOptions options;
    options.threads = threads;
    reports.push_back(find(test::sideways(), options));
  }
  for (const GeodesicReport& report : reports) {
    EXPECT_EQ(report.geodesics[0].p0, reports[0].geodesics[0].p0);
    EXPECT_EQ(report.starts, reports[0].starts);
    EXPECT_EQ(report.converged_starts, reports[0].converged_starts);
  }
}

TEST(Geodesic, CeresAndNloptAgree) {
  GeodesicOptions options;
  options.minimiser = "nlopt";
  const GeodesicReport report = find(test::sideways(), options);
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].action, kSideways, kRelative * kSideways);
}

TEST(Geodesic, CountReturnsMirrorPartnersFirst) {
  GeodesicOptions options;
  options.count = 2;
  options.starts = 24;
  const GeodesicReport report = find(test::sideways(), options);
  ASSERT_EQ(report.geodesics.size(), 2U);
  EXPECT_NEAR(report.geodesics[0].action, kSideways, kRelative * kSideways);
  EXPECT_NEAR(report.geodesics[1].action, kSideways, kRelative * kSideways);
  EXPECT_NEAR(report.geodesics[0].p0[0], -report.geodesics[1].p0[0], 1e-8);
}

TEST(Geodesic, MaxLengthLeavesOutWhatIsLonger) {
  GeodesicOptions options;
  options.all = true;
  options.starts = 24;
  options.max_length = 6.75;
  for (const Geodesic& geodesic : find(test::sideways(), options).geodesics) {
    EXPECT_LE(geodesic.length.value(), options.max_length);
  }
}

TEST(Geodesic, StraightAheadIsExact) {
  const GeodesicReport report = find(test::straight_ahead());
  ASSERT_EQ(report.geodesics.size(), 1U);
  EXPECT_NEAR(report.geodesics[0].action, 0.5, 1e-14);
  EXPECT_NEAR(report.geodesics[0].p0[0], 1, 1e-13);
}

TEST(Geodesic, StayingIsAnAnswer) {
  const GeodesicReport report = find(test::vehicle({1, 2, 3, 4}, {1, 2, 3, 4}));
  EXPECT_EQ(report.status, GeodesicStatus::kConverged);
  ASSERT_EQ(report.geodesics.size(), 1U);
  EXPECT_EQ(report.geodesics[0].action, 0);
  EXPECT_EQ(report.geodesics[0].p0, std::vector<double>(4, 0.0));
  EXPECT_EQ(report.geodesics[0].trajectory.q.back(), (std::vector<double>{1, 2, 3, 4}));
}

// The line x2 = t of the Engel group: of its covectors, (0, 1, 0, c), the least.
TEST(Geodesic, AbnormalLinesOfTheEngelGroup) {
  for (const double y : {1.0, -1.0, 2.0, 3.0}) {
    const GeodesicReport report = find(test::engel({0, y, 0, y * y * y / 6}));
    ASSERT_FALSE(report.geodesics.empty()) << y;
    const Geodesic& line = report.geodesics[0];
    EXPECT_NEAR(line.action, 0.5 * y * y, 1e-13 * y * y);
    EXPECT_EQ(line.abnormal, true) << y;
    EXPECT_EQ(line.label, Label::kLocallyMinimal) << y;
    EXPECT_NEAR(line.p0[3], 0, 1e-8) << y;
  }
}

// Leaves the abnormal line y = 0 exponentially, and late: as near to it as round-off for half of
// the time.
TEST(Geodesic, LeavingAnAbnormalLineIsNotAbnormal) {
  for (const double y : {0.05, 0.1}) {
    const GeodesicReport report = find(test::martinet({1, y, 0}));
    ASSERT_FALSE(report.geodesics.empty()) << y;
    EXPECT_EQ(report.geodesics[0].abnormal, false) << y;
  }
}

// A target beside the line (x, 0, 0) by z is reached by a path that ends there, not by one whose
// gaps at many knots add up to z: to leading order its action is 1/2 + pi^2 z.
TEST(Geodesic, GapsAtKnotsDoNotMakeUpForTheTarget) {
  for (const double z : {1e-8, 1e-9}) {
    const GeodesicReport report = find(test::martinet({1, 0, z}));
    ASSERT_FALSE(report.geodesics.empty()) << z;
    EXPECT_EQ(report.geodesics[0].verification, Verification::kSingle);
    EXPECT_NEAR(report.geodesics[0].action - 0.5, kPi * kPi * z, 1e-6 * z);
  }
}

TEST(Geodesic, SteeringABicycleInPlace) {
  for (const double delta : {1.0, 1.5}) {
    const GeodesicReport report = find(test::bicycle({0, 0, 0, delta}));
    ASSERT_FALSE(report.geodesics.empty()) << delta;
    EXPECT_NEAR(report.geodesics[0].action, 0.5 * delta * delta, 1e-12);
  }
}

// Both ends say that a radian of heading is worth 230 radians of steering. On the way it is not.
TEST(Geodesic, ABicycleThatEndsNearlyStraightIsFoundWithAnySeed) {
  const BoundaryValueProblem problem =
      test::bicycle({-1.1101797278486008, 1.13736594130031, -1.1998678673068401, -0.0043});
  EXPECT_EQ(below(3.708, of_seeds(problem, 0, 7)), 8);
}

// By left translation the target 1e-3 above any point is as far as above the origin: 2 pi z.
TEST(Geodesic, NearTargetsAreFoundAwayFromTheOrigin) {
  BoundaryValueProblem problem = test::heisenberg_group({1, 1, 1.001});
  problem.from = {1, 1, 1};
  const GeodesicReport report = find(problem);
  ASSERT_FALSE(report.geodesics.empty());
  EXPECT_NEAR(report.geodesics[0].action, 2 * kPi * 1e-3, 1e-10);
}

// Displacements that take brackets: extremals come in near families, some of which are saddles.
TEST(Geodesic, NearTargetsInAnyDirection) {
  struct Near {
    BoundaryValueProblem problem;
    double action;  // the least of many searches
  };
  const std::vector<Near> list{
      {test::vehicle({0, 0, 0, 0}, {7.097e-4, 7.246e-4, 5.855e-5, 5.369e-4}), 0.15403200806},
      {test::engel({2.911e-5, 6.495e-5, -5.134e-6, -8.183e-6}), 0.00814605038697},
      {test::bicycle({0, 1e-6, 0, 0}), 0.00202941420323}};
  constexpr double kDigits = 1e-9;  // of those numbers
  for (const Near& near : list) {
    for (const std::uint64_t seed : {0, 1}) {
      GeodesicOptions options;
      options.seed = seed;
      const GeodesicReport report = find(near.problem, options);
      ASSERT_FALSE(report.geodesics.empty()) << near.action;
      EXPECT_NEAR(report.geodesics[0].action / near.action, 1, kDigits) << near.action;
      EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal) << near.action;
    }
  }
}

// On the singular line of the Grushin plane the action is pi |dy|, wherever y is.
TEST(Geodesic, OnTheSingularLineOfTheGrushinPlane) {
  for (const double away : {1e-3, 1e-5}) {
    const GeodesicReport report = find(test::grushin({0, 1}, {0, 1 + away}));
    ASSERT_FALSE(report.geodesics.empty()) << away;
    EXPECT_NEAR(report.geodesics[0].action, kPi * away, 1e-9 * away);
  }
}

TEST(Geodesic, SteeringInPlaceIsAbnormalAndSolved) {
  const GeodesicReport report = find(test::vehicle({0, 0, 0, 0}, {0, 0, 0, kPi / 2}));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].action, kPi * kPi / 8, 1e-10);
  EXPECT_EQ(report.geodesics[0].abnormal, true);
  EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
}

// Sideways by a the action grows like a^(2/3) as a -> 0, and the extremal comes ever nearer to one
// of a continuum: by 1e-10 double can't tell whether T is conjugate, and the label says so.
TEST(Geodesic, ShortPathsAreSolvedAndNotMislabelled) {
  const GeodesicReport far = find(test::vehicle({0, 0, 0, 0}, {0, 1e-7, 0, 0}));
  const GeodesicReport near = find(test::vehicle({0, 0, 0, 0}, {0, 1e-10, 0, 0}));
  ASSERT_EQ(far.status, GeodesicStatus::kConverged) << far.message;
  ASSERT_EQ(near.status, GeodesicStatus::kConverged) << near.message;
  EXPECT_EQ(far.geodesics[0].label, Label::kLocallyMinimal);
  EXPECT_EQ(near.geodesics[0].label, Label::kUnknown);
  EXPECT_EQ(near.geodesics[0].abnormal, false);
  const Geodesic& path = near.geodesics[0];
  const bool single = path.verification == Verification::kSingle;
  EXPECT_LE(single ? path.endpoint_error : path.knot_defect, 1e-3 * 1e-10);  // of the distance
  EXPECT_NEAR(near.geodesics[0].action / far.geodesics[0].action, 1e-2, 1e-6);
}

TEST(Geodesic, HeisenbergGroupClosedForm) {
  // The dido problem: a full circle that encloses area z has length 2 sqrt(pi z).
  const GeodesicReport report = find(test::heisenberg_group({0.5, 0, 2}));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  const Geodesic& geodesic = report.geodesics[0];
  const double w = geodesic.p0[2];
  const double radius = std::hypot(geodesic.p0[0], geodesic.p0[1]) / std::abs(w);
  // Chord 2 r |sin(w/2)| and area r^2 (w - sin w)/2 of the arc of angle w.
  EXPECT_NEAR(2 * radius * std::abs(std::sin(w / 2)), 0.5, 1e-9);
  EXPECT_NEAR(0.5 * radius * radius * (w - std::sin(w)), 2, 1e-9);
}

TEST(Geodesic, UnicycleSideways) {
  const GeodesicReport report = find(test::unicycle({0, 0, 0}, {0, 1, 0}));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].length.value(), 3.3403830192305876, 1e-9);
}

TEST(Geodesic, WithAPotential) {
  const GeodesicReport report = find(test::vehicle_cosine({1, 0.5, 0.3, 0.8}, {2, 1, 0.5, 0.5}, 2));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_LE(report.geodesics[0].endpoint_error, 1e-10);
  EXPECT_LE(report.geodesics[0].energy_drift, 1e-12);
}

TEST(Geodesic, WithoutConstraints) {
  const GeodesicReport report = find(test::oscillator({1, 0}, {0, 1}, 1));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].p0[0], -std::cos(1.0) / std::sin(1.0), 1e-10);
  EXPECT_NEAR(report.geodesics[0].p0[1], 1 / std::sin(1.0), 1e-10);
}

// What is hit once may be anything, and a guess says nothing of what else there is.
TEST(Geodesic, OneHitIsNotSureAndAGuessSaysNothing) {
  const BoundaryValueProblem problem = test::sideways();
  GeodesicOptions options;
  options.starts = 2;  // the straight line collapses
  const GeodesicReport one = find_geodesics(problem, options);
  ASSERT_EQ(one.converged_starts, 1) << one.message;
  EXPECT_GE(one.missed_estimate.value(), 1);
  const GeodesicReport many = find_geodesics(problem);
  ASSERT_EQ(many.status, GeodesicStatus::kConverged) << many.message;
  EXPECT_LT(many.missed_estimate.value(), 1);
  options = {};
  options.guess = many.geodesics[0].p0;
  EXPECT_FALSE(find_geodesics(problem, options).missed_estimate);
}

// One of hundreds of extremals. Without crossings 3 seeds of 12 find it, with them 22 of 24.
// Round-off decides which paths lead where: each build finds it with other seeds.
TEST(Geodesic, CrossingsFindTheLeastOfHundreds) {
  const BoundaryValueProblem problem =
      test::falling_cat({-2.6723620111680537, -2.8763280169473195, -2.7966511206744067});
  const std::vector<GeodesicReport> reports = of_seeds(problem, 0, 8);
  for (const GeodesicReport& report : reports) {
    EXPECT_GE(report.missed_estimate.value(), 1) << "it is not sure";
  }
  EXPECT_GE(below(279.849, reports), 6);
}

// The least action begins the wrong way round, and two of three starts lead to another, at 44.62.
// Where no wiggle goes further than 1 rad, six of the first twelve seeds end with that one, three
// of these four among them. One does with wiggles of a full turn, and none of these.
TEST(Geodesic, OfAnglesMayBeginTheWrongWayRound) {
  const BoundaryValueProblem problem =
      test::falling_cat({2.3087139066936846, -2.6859618404918395, -2.300226686151836});
  EXPECT_GE(below(42.128, of_seeds(problem, 1, 4)), 3) << "round-off may change where a path leads";
}

// Of some seeds ten of the first twelve starts lead to one extremal, at 58.61. Searches that ended
// with it after so few starts missed the least action with three of the first six seeds.
TEST(Geodesic, OfAnglesMostStartsMayAgreeOnMore) {
  const BoundaryValueProblem problem =
      test::falling_cat({2.6523637696437818, -3.0978486087876798, -1.9557457780091838});
  EXPECT_GE(below(48.099, of_seeds(problem, 0, 7)), 7) << "round-off may change where a path leads";
}

TEST(Geodesic, FarTargetsAreVerifiedAtKnots) {
  // Nine lengths ahead with a turn: |dq(1)/dp0| is beyond what one forward run can carry.
  const GeodesicReport report = find(test::long_vehicle({0, 0, 0, 0}, {30, 10, 1, 1}, 1));
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  const Geodesic& geodesic = report.geodesics[0];
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_LE(geodesic.knot_defect, 1e-10);
  EXPECT_EQ(geodesic.trajectory.t.size(), 201U);
  EXPECT_TRUE(std::is_sorted(geodesic.trajectory.t.begin(), geodesic.trajectory.t.end()));
}

// A short steering axle on a long vehicle: boundary layers that the first grid does not see.
TEST(Geodesic, StiffVehiclesAreSolved) {
  const GeodesicReport sideways = find(test::stiff_vehicle({0, 1, 0, 0}));
  ASSERT_EQ(sideways.status, GeodesicStatus::kConverged) << sideways.message;
  EXPECT_NEAR(sideways.geodesics[0].action, 18.2411417333128, 1e-9);
  const GeodesicReport ahead = find(test::stiff_vehicle({50, 5, 0, 0}));
  ASSERT_EQ(ahead.status, GeodesicStatus::kConverged) << ahead.message;
  EXPECT_EQ(ahead.geodesics[0].verification, Verification::kKnots);
  EXPECT_LE(ahead.geodesics[0].knot_defect, 1e-10);
  EXPECT_EQ(ahead.geodesics[0].label, Label::kLocallyMinimal);
}

// Sideways by e costs e^(2/3): three brackets deep. The Engel group is the limit.
TEST(Geodesic, TinyDisplacementsNeedNoOptions) {
  const auto action = [](double e) {
    const GeodesicReport report = find(test::vehicle({0, 0, 0, 0}, {0, e, 0, 0}));
    EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
    return report.geodesics.empty() ? 0 : report.geodesics[0].action;
  };
  // The next term of the expansion is a path length, 0.06, smaller; measured 2e-5.
  EXPECT_NEAR(action(1e-6) / action(1e-9), 100, 0.02);
}

TEST(Geodesic, TheOriginDoesNotMatter) {
  const double x = 4.5e9;
  const double y = -3.5e8;
  const GeodesicReport here = find(test::sideways());
  const GeodesicReport there = find(test::vehicle({x, y, 0, 0}, {x, y + 1, 0, 0}));
  ASSERT_EQ(there.status, GeodesicStatus::kConverged) << there.message;
  EXPECT_EQ(there.geodesics[0].p0, here.geodesics[0].p0);
  EXPECT_EQ(there.geodesics[0].trajectory.q.front()[0], x);
  EXPECT_EQ(there.geodesics[0].trajectory.q.back()[1],
            y + here.geodesics[0].trajectory.q.back()[1]);
}

// Nor do cyclic coordinates: on a scene's axes they cost what they hold of the displacement.
TEST(Geodesic, CyclicCoordinatesCostNoDigits) {
  const auto expect_same = [](const BoundaryValueProblem& here) {
    constexpr double kFar = 1 << 20;  // and the sums are exact
    const GeodesicReport near = find(here);
    ASSERT_FALSE(near.geodesics.empty());
    BoundaryValueProblem there = here;
    for (const int j : internal::movable(here.dynamics.info)) {
      there.from[j] += kFar;
      there.to[j] += kFar;
    }
    const GeodesicReport far = find(there);
    ASSERT_FALSE(far.geodesics.empty());
    EXPECT_EQ(far.geodesics[0].p0, near.geodesics[0].p0);
    EXPECT_EQ(far.geodesics[0].trajectory.q.front(), there.from);
  };
  expect_same(test::grushin({0.5, 0}, {0, 0.25}));
  expect_same(test::martinet({0.5, 0.25, 1}));
  expect_same(test::engel({0.5, 0.25, 0.125, 1}));
  expect_same(test::heisenberg_group({0.5, 0, 2}));
  expect_same(test::satellite({0.5, 0.25, 0.125}));
  // On the singular line a displacement of 1e-7 beside 1.
  const GeodesicReport beside = find(test::grushin({0, 1}, {0, 1 + 1e-7}));
  ASSERT_FALSE(beside.geodesics.empty());
  EXPECT_NEAR(beside.geodesics[0].action, kPi * (1 + 1e-7 - 1), 1e-9 * 1e-7);
}

// The front wheel alone turns, some hundred thousand times; the target's last digit is 2e-10.
TEST(Geodesic, AWheelTurnsInPlace) {
  for (const double angle : {3e5, 1e6, 1.1e6, 2e6, 1e7}) {
    const GeodesicReport report = find(test::vehicle({0, 0, 0, 0}, {0, 0, 0, angle}));
    ASSERT_EQ(report.status, GeodesicStatus::kConverged) << angle << ": " << report.message;
    const Geodesic& best = report.geodesics[0];
    EXPECT_NEAR(best.action, angle * angle / 2, 4 * kEps * angle * angle);
    EXPECT_LE(std::max(best.endpoint_error, best.knot_defect), kEps * angle);
  }
}

TEST(Geodesic, TimeScalesTheAction) {
  const BoundaryValueProblem slow = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5}, 10);
  const BoundaryValueProblem quick = test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5}, 0.1);
  const double a = find(slow).geodesics.at(0).action;
  const double b = find(quick).geodesics.at(0).action;
  EXPECT_NEAR(100 * a, b, 1e-9 * b);
}

TEST(Geodesic, AGuessIsPolished) {
  GeodesicOptions options;
  options.guess = {2.1, -0.27, 1.16, 1.37};
  const GeodesicReport report = find(test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5}), options);
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].action, 3.197700949183654, 1e-10);
  EXPECT_EQ(report.starts, 1);
}

TEST(Geodesic, AHopelessGuessSaysSo) {
  GeodesicOptions options;
  options.guess = {1e8, 1e8, -1e8, 1e8};
  const GeodesicReport report = find(test::sideways(), options);
  EXPECT_EQ(report.status, GeodesicStatus::kNotConverged);
  EXPECT_NE(report.message.find("guess"), std::string::npos);
  EXPECT_TRUE(report.geodesics.empty());
}

std::string failure(const BoundaryValueProblem& problem, const GeodesicOptions& options) {
  const GeodesicReport report = find(problem, options);
  EXPECT_EQ(report.status, GeodesicStatus::kNotConverged);
  EXPECT_TRUE(report.geodesics.empty());
  return report.message;
}

TEST(Geodesic, FailureSaysWhyAndWhatToTry) {
  GeodesicOptions options;
  options.starts = 1;  // the straight line, which collapses
  const std::string collapsed = failure(test::vehicle({0, 0, 0, 0}, {0, 0.5, 0, 0}), options);
  EXPECT_NE(collapsed.find("collapsed"), std::string::npos) << collapsed;
  EXPECT_NE(collapsed.find("try more --starts"), std::string::npos) << collapsed;
  options = {};
  options.max_length = 2;
  const std::string longer = failure(test::unicycle({0, 0, 0}, {0, 1, 0}), options);
  EXPECT_NE(longer.find("length 3.34"), std::string::npos) << longer;
  options = {};
  options.tolerance = 1e-22;
  const std::string unverified = failure(test::sideways(), options);
  EXPECT_NE(unverified.find("rank 4 of 4 and condition"), std::string::npos) << unverified;
}

TEST(Geodesic, StopsWhenToldTo) {
  GeodesicOptions options;
  options.progress = [](double) { return false; };
  EXPECT_EQ(find(test::sideways(), options).status, GeodesicStatus::kInterrupted);
}

TEST(Geodesic, RefusesBadInput) {
  const std::vector<double> origin(4, 0.0);
  EXPECT_THROW(find(test::vehicle({0, 0, 0}, origin)), std::invalid_argument);
  EXPECT_THROW(find(test::vehicle(origin, {0, 0, 0, 0, 0})), std::invalid_argument);
  EXPECT_THROW(find(test::vehicle(origin, {0, NAN, 0, 0})), std::invalid_argument);
  EXPECT_THROW(find(test::vehicle(origin, {0, 1, 0, 0}, 0)), std::invalid_argument);
  EXPECT_THROW(find(test::vehicle(origin, {0, 1, 0, 0}, -1)), std::invalid_argument);
  EXPECT_THROW(test::long_vehicle(origin, {0, 1, 0, 0}, -1), std::invalid_argument);
  const auto refuse = [](auto change) {
    GeodesicOptions options;
    change(options);
    EXPECT_THROW(find(test::sideways(), options), std::invalid_argument);
  };
  refuse([](GeodesicOptions& o) { o.count = 0; });
  refuse([](GeodesicOptions& o) { o.starts = -1; });
  refuse([](GeodesicOptions& o) { o.threads = -1; });
  refuse([](GeodesicOptions& o) { o.samples = -1; });
  refuse([](GeodesicOptions& o) { o.tolerance = 0; });
  refuse([](GeodesicOptions& o) { o.max_length = 0; });
  refuse([](GeodesicOptions& o) { o.minimiser = "simplex"; });
  refuse([](GeodesicOptions& o) { o.guess = {1, 2}; });
}

}  // namespace
}  // namespace carnot::geodesic_test
