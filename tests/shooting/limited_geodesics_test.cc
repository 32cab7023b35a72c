// Geodesics with limits and obstacles: closed forms, one route against another, and what cannot be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "carnot/make_limit.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/interior_point.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/search/limited_finish.h"
#include "carnot/shooting/search/limited_problem.h"
#include "carnot/shooting/search/starts.h"
#include "carnot/shooting/shoot/bound_arcs.h"
#include "carnot/shooting/shoot/bound_survey.h"
#include "carnot/shooting/shoot/contacts.h"
#include "carnot/shooting/steering_function.h"
#include "carnot/shooting/warm_start.h"
#include "shooting/drift_problems.h"
#include "shooting/problems.h"

namespace carnot::internal::limited_geodesics_test {
namespace {

using ::testing::HasSubstr;

// Sideways parking with |phi - theta| <= 0.3, as a direct method and the exact arcs of an earlier
// program agree on it.
constexpr double kParking = 23.275244006;
constexpr double kViolation = 1e-10;

// A scene of the program from its text, with more lines.
Dynamics program_scene(const std::string& name, const std::string& lines) {
  const std::string path = CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + name + ".scene";
  return test::from_text(load_scene(path).text() + "\n" + lines);
}

BoundaryValueProblem parking(const std::string& limits) {
  return {program_scene("vehicle", limits), {0, 0, 0, 0}, {0, 1, 0, 0}};
}

GeodesicReport solve(const BoundaryValueProblem& problem, int count = 1, int threads = 0) {
  GeodesicOptions options;
  options.count = count;
  options.threads = threads;
  return find_geodesics(problem, options);
}

Geodesic best(const BoundaryValueProblem& problem) {
  const GeodesicReport report = solve(problem);
  EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  return report.geodesics.empty() ? Geodesic{} : report.geodesics.front();
}

// The samples keep to the limits, and the path ends where it should.
void expect_kept(const BoundaryValueProblem& problem, const Geodesic& geodesic) {
  EXPECT_LE(geodesic.limit_violation, kViolation);
  ASSERT_EQ(geodesic.limits.size(), problem.limits.size());
  for (const auto& q : geodesic.trajectory.q) {
    for (const Limit& limit : problem.limits) {
      EXPECT_GE(limit.slack(limit.value(q.data(), nullptr, nullptr)), -kViolation) << limit.name;
    }
  }
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (problem.is_free_to(j)) continue;
    EXPECT_NEAR(geodesic.trajectory.q.back()[j], problem.to[j], 1e-9);
  }
}

// A limit is broken where its expression is no number: here to the left of x = 0.95, where the
// shortest path goes. Another end of the path has a value, which must not hide that.
TEST(LimitedGeodesics, AreBrokenWhereTheyHaveNoValue) {
  constexpr double kLeast = 0.95;
  const auto problem = [](const std::string& limits) {
    return BoundaryValueProblem{program_scene("unicycle", limits), {1, 0, 0}, {1, 0.3, 0}};
  };
  const auto leftmost = [](const Geodesic& geodesic) {
    double least = 1;
    for (const auto& q : geodesic.trajectory.q) least = std::min(least, q[0]);
    return least;
  };
  EXPECT_LT(leftmost(best(problem(""))), kLeast);
  const Geodesic geodesic = best(problem("limit -1 < sqrt(x - 0.95) < 5 \"root\"\n"));
  EXPECT_GE(leftmost(geodesic), kLeast);
  EXPECT_GE(geodesic.limits.at(0).lowest_slack, 1);
  BoundaryValueProblem outside = problem("limit -1 < sqrt(x - 0.95) < 5 \"root\"\n");
  outside.to[0] = 0.9;
  EXPECT_THAT(solve(outside).message, HasSubstr("the limit 'root' has no value at the target"));
}

TEST(LimitedGeodesics, ParkWithAWheelThatTurnsLittle) {
  const BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3 \"steering\"\n");
  const Geodesic geodesic = best(problem);
  EXPECT_NEAR(geodesic.action, kParking, 1e-9 * kParking);
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_LE(geodesic.knot_defect, 1e-10);
  EXPECT_EQ(geodesic.label, Label::kLocallyMinimal);
  expect_kept(problem, geodesic);
  const LimitReport& limit = geodesic.limits[0];
  EXPECT_EQ(limit.name, "steering");
  EXPECT_EQ(limit.active.size(), 4U);
  EXPECT_GT(limit.largest_multiplier, 0);
  EXPECT_NEAR(geodesic.extremes.at(0).second, 0.3, kViolation);
  for (const auto& [begin, end] : limit.active) EXPECT_LT(begin, end);
}

TEST(LimitedGeodesics, AreAsBeforeWhereNoLimitIsReached) {
  const Geodesic free = best(parking(""));
  const Geodesic wide = best(parking("limit -0.5 < phi - theta < 0.5\n"));
  EXPECT_EQ(wide.action, free.action);
  EXPECT_EQ(wide.p0, free.p0);
  EXPECT_EQ(wide.trajectory.q, free.trajectory.q);
  EXPECT_EQ(wide.conjugate_times, free.conjugate_times);
  EXPECT_NEAR(wide.limits.at(0).lowest_slack, 0.5 - free.extremes.at(0).second, 1e-4);
  EXPECT_TRUE(wide.limits.at(0).active.empty());
}

// A car whose steering is light turns it almost at once, and flows along such a path magnify. Its
// pieces are joined from more, shorter flows. The limit from C++ has no arcs, so its answer is that
// of the grid.
TEST(LimitedGeodesics, JoinPiecesThatMagnify) {
  const std::string car = R"(
    coordinates x, y [length], theta, phi [angle]
    kinetic = (x'^2 + y'^2 + 1.2 theta'^2 + 0.001 phi'^2) / 2
    0 = x' sin(theta) - y' cos(theta)
    0 = 2.7 theta' cos(phi) - (x' cos(theta) + y' sin(theta)) sin(phi)
  )";
  const std::vector<double> target{7.09371, 1.48975, 1.2027, -0.30944};
  const BoundaryValueProblem problem(
      test::from_text(car + "limit -0.6 < phi < 0.6\n"), {0, 0, 0, 0}, target);
  BoundaryValueProblem direct(test::from_text(car), {0, 0, 0, 0}, target);
  direct.limits = {make_limit<4>(
      "steering", [](const auto& q) { return q[3]; }, -0.6, 0.6)};
  const Geodesic geodesic = best(problem);
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_LE(geodesic.knot_defect, 1e-10);
  expect_kept(problem, geodesic);
  const Geodesic on_grid = best(direct);
  EXPECT_EQ(on_grid.verification, Verification::kGrid);
  EXPECT_NEAR(geodesic.action, on_grid.action, on_grid.grid_error);
}

// The vehicle with light steering and a limit from C++, which has no arcs: its answers are on
// grids.
BoundaryValueProblem light_and_limited(double beta) {
  BoundaryValueProblem problem = test::light_steering({1, 1, 0.5, 0.2}, beta);
  problem.limits = {make_limit<4>(
      "steering", [](const auto& q) { return q[3] - q[2]; }, -0.6, 0.6)};
  return problem;
}

// From the straight line, on the rung that 64 intervals are enough for.
Candidate heavy_candidate(const LimitedProblem& shared) {
  constexpr int kIntervals = 64;
  const int rung = shared.ladder.rung_for(kIntervals);
  const BoundaryValueProblem& problem = shared.ladder.on(rung);
  Candidate candidate;
  candidate.limited.path = make_start(problem, 0, 0, kIntervals).path;
  candidate.limited.path.lambda.assign(2 * kIntervals, 0.0);
  candidate.limited.path.rung = rung;
  InteriorPointOptions interior = shared.interior;
  interior.last_mu = kFirstGridMu;
  EXPECT_TRUE(interior_point(problem, shared.walls, interior, candidate.limited).converged);
  candidate.action = discrete_action(problem.dynamics, 1.0 / kIntervals, candidate.limited.path);
  return candidate;
}

// The more a coordinate weighs, the more action it takes: candidates lose some on each rung. At the
// foot they are on a grid that resolves their layers, and extremals of the problem itself.
TEST(LimitedGeodesics, GoDownTheLadderOfMasses) {
  const BoundaryValueProblem problem = light_and_limited(1e-3);
  const LimitedProblem shared(problem, {});
  const GeodesicOptions options;
  const LimitedFinish finish(shared, options);
  Candidate candidate = heavy_candidate(shared);
  const int rung = candidate.limited.path.rung;
  const int intervals = candidate.limited.path.intervals;
  ASSERT_GT(rung, 0);
  for (int below = rung - 1; below >= 0; --below) {
    const double before = candidate.action;
    ASSERT_TRUE(finish.refine(candidate, kFirstGridMu)) << below;
    EXPECT_EQ(candidate.limited.path.rung, below);
    EXPECT_LT(candidate.action, before);
  }
  EXPECT_EQ(candidate.halvings, rung);
  EXPECT_EQ(candidate.limited.path.intervals, intervals << rung);
  LimitedPath again = candidate.limited;
  InteriorPointOptions interior = shared.interior;
  interior.first_mu = interior.last_mu = kFirstGridMu;
  const InteriorPoint solved = interior_point(problem, shared.walls, interior, again);
  EXPECT_TRUE(solved.converged);
  EXPECT_EQ(solved.iterations, 0);
}

// However many rungs a candidate came down, two grids tell its action, and its error with it.
// Layers leave an error of 1e-6 or more on grids that one can afford.
TEST(LimitedGeodesics, TellTheErrorOfAGridThatIsFineAlready) {
  constexpr double kLeastError = 1e-7;
  constexpr int kManyRungs = 4;
  const BoundaryValueProblem problem = light_and_limited(1e-4);
  const LimitedProblem shared(problem, {});
  const GeodesicOptions options;
  const LimitedFinish finish(shared, options);
  Candidate candidate = heavy_candidate(shared);
  ASSERT_GE(candidate.limited.path.rung, kManyRungs);
  while (candidate.limited.path.rung > 0) {
    ASSERT_TRUE(finish.refine(candidate, kFirstGridMu)) << candidate.limited.path.rung;
  }
  const auto finished = finish.finish(candidate);
  ASSERT_TRUE(finished);
  const Geodesic& geodesic = finished->geodesic;
  EXPECT_EQ(geodesic.verification, Verification::kGrid);
  EXPECT_GT(geodesic.grid_error, kLeastError * geodesic.action);
  EXPECT_LT(geodesic.grid_error, 1e-2 * geodesic.action);
}

// Where steering is light starts take many ways, and lead to one geodesic.
TEST(LimitedGeodesics, WithLightSteeringAgreeForSeeds) {
  constexpr double kSame = 1e-8;
  for (const std::vector<double>& to :
       {std::vector<double>{1, 1, 0.5, 0.2}, {-1, 0.5, 0.2, 0.3}, {0, 1, 0, 0}}) {
    const BoundaryValueProblem problem(test::from_text(R"(
      coordinates x, y [length], theta, phi [angle]
      kinetic = (x'^2 + y'^2 + theta'^2 + 0.01 phi'^2) / 2
      0 = x' sin(theta) - y' cos(theta)
      0 = theta' cos(phi) - (x' cos(theta) + y' sin(theta)) sin(phi)
      limit -0.6 < phi < 0.6
    )"),
                                       {0, 0, 0, 0},
                                       to);
    std::vector<double> actions;
    for (const std::uint64_t seed : {0, 1, 2}) {
      GeodesicOptions options;
      options.seed = seed;
      const GeodesicReport report = find_geodesics(problem, options);
      ASSERT_FALSE(report.geodesics.empty()) << report.message;
      const Geodesic& geodesic = report.geodesics.front();
      EXPECT_EQ(geodesic.verification, Verification::kKnots);
      expect_kept(problem, geodesic);
      actions.push_back(geodesic.action);
    }
    EXPECT_NEAR(actions[1], actions[0], kSame * actions[0]);
    EXPECT_NEAR(actions[2], actions[0], kSame * actions[0]);
  }
}

TEST(LimitedGeodesics, DoNotDependOnThreads) {
  const BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3\n");
  const GeodesicReport one = solve(problem, 2, 1);
  const GeodesicReport three = solve(problem, 2, 3);
  ASSERT_EQ(one.geodesics.size(), 2U);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(one.geodesics[i].p0, three.geodesics.at(i).p0);
}

// Two limits that share the mirror symmetry of the problem leave its partners the same action; one
// does not.
TEST(LimitedGeodesics, ShareTheMirrorSymmetryOfTheirLimitsOnly) {
  const GeodesicReport both = solve(parking("limit -0.3 < phi - theta < 0.3\n"), 2);
  ASSERT_EQ(both.geodesics.size(), 2U);
  EXPECT_NEAR(both.geodesics[0].action, both.geodesics[1].action, 1e-9);
  const GeodesicReport left = solve(parking("limit phi - theta > -0.3\n"), 2);
  const GeodesicReport right = solve(parking("limit phi - theta < 0.3\n"), 2);
  ASSERT_EQ(left.geodesics.size(), 2U);
  EXPECT_GT(left.geodesics[1].action, left.geodesics[0].action + 1e-3);
  EXPECT_NEAR(left.geodesics[0].action, right.geodesics.at(0).action, 1e-9);
}

// More freedom never costs more: a wider limit, a free end.
TEST(LimitedGeodesics, CostLessWithMoreFreedom) {
  double last = std::numeric_limits<double>::infinity();
  for (const char* limit : {"0.25", "0.3", "0.35", "0.4", "0.45"}) {
    const std::string line = std::string("limit -") + limit + " < phi - theta < " + limit + "\n";
    BoundaryValueProblem problem = parking(line);
    const double action = best(problem).action;
    EXPECT_LT(action, last) << limit;
    last = action;
    problem.free_to = {false, false, false, true};
    const Geodesic free = best(problem);
    EXPECT_LE(free.action, action);
    expect_kept(problem, free);
    EXPECT_LE(free.transversality_error, 1e-9);
  }
}

// The same problem on the grid, extrapolated: another route to the same action.
// The best extremal that so many starts find without limits keeps to the limit, but it is past a
// conjugate time. There is a minimum at the limit that is shorter.
TEST(LimitedGeodesics, AreSearchedWhereTheFreeOneIsNoMinimum) {
  const auto best_of = [](const std::string& limit) {
    std::string text = load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/bicycle.scene").text();
    const std::string one = "length = 1";
    text.replace(text.find(one), one.size(), "length = 2");
    GeodesicOptions options;
    options.starts = 48;
    const BoundaryValueProblem problem(test::from_text(text + limit), {0, 0, 0, 0}, {0, 1, 0, 0});
    const GeodesicReport report = find_geodesics(problem, options);
    EXPECT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
    return report.geodesics.empty() ? Geodesic{} : report.geodesics.front();
  };
  const Geodesic free = best_of("");
  ASSERT_EQ(free.label, Label::kConjugatePassed);
  ASSERT_LT(free.extremes.at(0).second, 1.2);
  const Geodesic limited = best_of("\nlimit -1.2 < delta < 1.2\n");
  EXPECT_LT(limited.action, free.action);
  EXPECT_EQ(limited.label, Label::kLocallyMinimal);
}

TEST(LimitedGeodesics, AgreeWithTheirGrid) {
  const BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3\n");
  // The limit from C++ has no arcs, so its answer is that of the grid.
  BoundaryValueProblem direct = problem;
  direct.limits = {make_limit<4>(
      "steering", [](const auto& q) { return q[3] - q[2]; }, -0.3, 0.3)};
  const Geodesic geodesic = best(direct);
  EXPECT_EQ(geodesic.verification, Verification::kGrid);
  EXPECT_NEAR(geodesic.action, kParking, 1e-6);
  EXPECT_LE(std::abs(geodesic.action - kParking), geodesic.grid_error);
  EXPECT_LE(geodesic.limit_violation, kViolation);
}

// The program's vehicle. A class of its own, so that what is compiled of it here does not take the
// place of what is compiled, faster, of the program's.
struct Car {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 2;

  template <class T>
  Matrix<T, 4, 4> mass(const Vector<T, 4>& /*q*/) const {
    return diagonal<T>(1, 1, 1, 1);
  }
  template <class T>
  Matrix<T, 2, 4> constraints(const Vector<T, 4>& q) const {
    using std::cos, std::sin;
    Matrix<T, 2, 4> g;
    g << sin(q[3]), -cos(q[3]), 0, 0, sin(q[2]), -cos(q[2]), 1, 0;
    return g;
  }
};

// With its scene a limit from C++ has arcs, and they are those of the text.
TEST(LimitedGeodesics, AreExactWithScenesOfCpp) {
  BoundaryValueProblem problem(make_dynamics(Car{}), {0, 0, 0, 0}, {0, 1, 0, 0});
  problem.limits = {make_limit(
      Car{}, "steering", [](const auto& q) { return q[3] - q[2]; }, -0.3, 0.3)};
  const Geodesic geodesic = best(problem);
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_NEAR(geodesic.action, kParking, 1e-9 * kParking);
  EXPECT_EQ(geodesic.limits[0].active.size(), 4U);
  EXPECT_LE(geodesic.limit_violation, kViolation);
}

// Bryson & Denham: x'' = u, x <= l, from rise to fall at unit speed. Without contact 2, at a point
// of contact 2 + 6 (1 - 4 l)^2, along the wall 4 / (9 l).
TEST(LimitedGeodesics, SolveTheProblemOfBrysonAndDenham) {
  const auto problem = [](double l) {
    std::string text = "coordinates x, v\ncontrols u\nx' = v\nv' = u\ncost = u^2 / 2\n";
    text += "limit x < " + std::to_string(l) + "\n";
    return BoundaryValueProblem(test::from_text(text), {0, 1}, {0, -1}, 1);
  };
  EXPECT_NEAR(best(problem(0.3)).action, 2, 1e-9);
  const Geodesic touch = best(problem(0.2));
  EXPECT_NEAR(touch.action, 2.24, 1e-9);
  ASSERT_EQ(touch.limits.at(0).active.size(), 1U);
  EXPECT_NEAR(touch.limits[0].active[0].first, 0.5, 1e-9);
  const Geodesic along = best(problem(0.125));
  EXPECT_NEAR(along.action, 4 / (9 * 0.125), 1e-9);
  ASSERT_EQ(along.limits.at(0).active.size(), 2U);
  EXPECT_NEAR(along.limits[0].active[0].first, 3 * 0.125, 1e-7);
  EXPECT_NEAR(along.limits[0].active[1].first, 1 - 3 * 0.125, 1e-7);
  EXPECT_LE(along.limit_violation, kViolation);
}

// Round a disc on either side; straight across its middle both ways are the same.
TEST(LimitedGeodesics, PassADiscOnBothSides) {
  const auto round = [](const std::string& centre) {
    const Dynamics dynamics = program_scene("unicycle", "disc (" + centre + "), 0.5\n");
    return BoundaryValueProblem(dynamics, {0, 0, 0}, {4, 0, 0});
  };
  const GeodesicReport even = solve(round("2, 0"), 2);
  ASSERT_EQ(even.geodesics.size(), 2U);
  EXPECT_NEAR(even.geodesics[0].action, even.geodesics[1].action, 1e-9);
  const GeodesicReport uneven = solve(round("2, 0.1"), 2);
  ASSERT_EQ(uneven.geodesics.size(), 2U);
  EXPECT_GT(uneven.geodesics[1].action, uneven.geodesics[0].action + 1);
  // By symmetry the path touches the disc below its middle, and p jumps across it there.
  const Geodesic& below = uneven.geodesics[0];
  expect_kept(round("2, 0.1"), below);
  ASSERT_EQ(below.limits.at(0).active.size(), 1U);
  EXPECT_NEAR(below.limits[0].active[0].first, 0.5, 1e-7);
  EXPECT_NEAR(below.limits[0].lowest_slack, 0, kViolation);
  const auto& p = below.trajectory.p;
  EXPECT_NEAR(p.front()[0], p.back()[0], 1e-7);
  EXPECT_NEAR(p.front()[1], -p.back()[1], 1e-7);
}

TEST(LimitedGeodesics, SolveRandomTargets) {
  constexpr int kTargets = 12;
  const Dynamics dynamics = program_scene("trailer1", "limit -0.5 < t0 - t1 < 0.5\n");
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-2, 2);
  std::uniform_real_distribution<double> hinge(-0.45, 0.45);
  for (int i = 0; i < kTargets; ++i) {
    std::vector<double> to{place(random), place(random), 0.7 * place(random), 0};
    to[3] = to[2] + hinge(random);
    const BoundaryValueProblem problem(dynamics, {0, 0, 0, 0}, to);
    const Geodesic geodesic = best(problem);
    EXPECT_NE(geodesic.verification, Verification::kGrid) << i;
    expect_kept(problem, geodesic);
  }
}

TEST(LimitedGeodesics, SayWhatCannotBe) {
  const GeodesicReport outside = solve(parking("limit y > 0.2 \"kerb\"\n"));
  EXPECT_EQ(outside.reason, Reason::kLimitAtEnd);
  EXPECT_THAT(outside.message, HasSubstr("the start is beyond the limit 'kerb' by 0.2"));
  const GeodesicReport target = solve(parking("limit y < 0.5\n"));
  EXPECT_THAT(target.message, HasSubstr("the target is beyond"));
  // A wall across the way.
  const GeodesicReport closed = solve(parking("limit (y - 0.5)^2 > 0.01 \"wall\"\n"));
  EXPECT_EQ(closed.status, GeodesicStatus::kNotConverged);
  EXPECT_EQ(closed.reason, Reason::kLimitsInfeasible);
  EXPECT_THAT(closed.message, HasSubstr("beyond 'wall'"));
  EXPECT_TRUE(closed.geodesics.empty());
  // A free coordinate may be moved within the limit, so the end itself is no obstacle.
  BoundaryValueProblem free = parking("limit -0.3 < phi - theta < 0.3\n");
  free.to[3] = 1;
  free.free_to = {false, false, false, true};
  EXPECT_EQ(best(free).limit_violation, std::max(0.0, best(free).limit_violation));
}

// Paths are judged at many times, however few samples are asked for.
TEST(LimitedGeodesics, AreCheckedWithoutSamples) {
  for (const char* limit : {"0.3", "0.5"}) {
    const std::string line = std::string("limit -") + limit + " < phi - theta < " + limit + "\n";
    const BoundaryValueProblem problem = parking(line);
    const Geodesic full = best(problem);
    for (const long samples : {0L, 1L, 2L}) {
      GeodesicOptions options;
      options.samples = samples;
      const Geodesic geodesic = find_geodesics(problem, options).geodesics.at(0);
      EXPECT_EQ(geodesic.p0, full.p0);
      EXPECT_EQ(geodesic.limits.at(0).lowest_slack, full.limits.at(0).lowest_slack);
      EXPECT_EQ(geodesic.trajectory.t.size(), static_cast<std::size_t>(samples));
    }
  }
}

// A free end may be on a wall, which stops it there.
TEST(LimitedGeodesics, MayEndOnAWall) {
  BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3 \"steering\"\n");
  problem.free_to = {false, false, false, true};
  const Geodesic geodesic = best(problem);
  EXPECT_EQ(geodesic.verification, Verification::kKnots);
  EXPECT_LE(geodesic.knot_defect, 1e-10);
  EXPECT_LE(geodesic.transversality_error, 1e-9);
  EXPECT_NEAR(std::abs(geodesic.to[3]), 0.3, 1e-12);
  EXPECT_NEAR(geodesic.limits.at(0).active.back().second, 1, 1e-12);
  expect_kept(problem, geodesic);
  // No other end costs less, and the same end costs as much.
  problem.free_to.clear();
  problem.to[3] = geodesic.to[3];
  const double fixed = best(problem).action;
  EXPECT_LE(geodesic.action, fixed * (1 + 1e-9));
  EXPECT_NEAR(geodesic.action, fixed, 1e-5 * fixed);  // that one is on a grid
  for (const double share : {0.97, 0.5, -1.0}) {
    problem.to[3] = share * geodesic.to[3];
    EXPECT_GE(best(problem).action, geodesic.action * (1 - 1e-9)) << share;
  }
}

// What rounding puts beyond a wall is on it; what is further away is refused.
TEST(LimitedGeodesics, EndsOnAWallMayBeBeyondItByARounding) {
  BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3 \"steering\"\n");
  problem.to[3] = std::nextafter(0.3, 1.0);
  const Geodesic geodesic = best(problem);
  EXPECT_NEAR(geodesic.trajectory.q.back()[3], 0.3, 1e-12);
  expect_kept(problem, geodesic);
  problem.to[3] = 0.3 * (1 + 1e-12);
  EXPECT_EQ(solve(problem).reason, Reason::kLimitAtEnd);
}

// An image of the target that is beyond a limit is none to go to; the others are.
TEST(LimitedGeodesics, GoToTheImagesThatKeepToLimits) {
  BoundaryValueProblem problem = parking("limit -0.5 < phi - theta < 0.5 \"steering\"\n");
  const double action = best(problem).action;
  problem.to[3] = 2 * std::acos(-1.0);
  EXPECT_EQ(solve(problem).reason, Reason::kLimitAtEnd);
  GeodesicOptions options;
  options.mod_angles = true;
  const GeodesicReport report = find_geodesics(problem, options);
  ASSERT_EQ(report.status, GeodesicStatus::kConverged) << report.message;
  EXPECT_NEAR(report.geodesics[0].action, action, 1e-9 * action);
  EXPECT_EQ(report.geodesics[0].windings.at(3), -1);
}

// What does not keep to limits says so, instead of an answer that is beyond them.
TEST(LimitedGeodesics, AreNotLeftToWhatKnowsNoLimits) {
  const BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3\n");
  EXPECT_THROW(SteeringFunction(problem.dynamics, {}), std::invalid_argument);
  EXPECT_THROW(WarmStart(problem, {1, 2, 3, 4}), std::invalid_argument);
}

// The other kinds: a Lagrangian with a wall at the point that it would pass, and one on a manifold.
TEST(LimitedGeodesics, AreOfEveryKind) {
  // x'' = -x over pi from 1 to -1 is cos t; with x <= 1.2 and speed to spare it is the same.
  const auto spring = [](const std::string& limit) {
    return test::from_text("coordinates x, y\nlagrangian = (x'^2 + y'^2 - x^2 - y^2) / 2\n" +
                           limit);
  };
  const BoundaryValueProblem free(spring(""), {1, 0}, {-1, 0.2}, 2);
  const BoundaryValueProblem wall(spring("limit (x - 0.1)^2 + y^2 > 0.09\n"), {1, 0}, {-1, 0.2}, 2);
  const Geodesic round = best(wall);
  EXPECT_GT(round.action, best(free).action);
  expect_kept(wall, round);
  const Dynamics pendulum = program_scene("spherical-pendulum", "limit z < 0.3\n");
  const BoundaryValueProblem swing(pendulum, {1, 0, 0}, {-1, 0, 0}, 1);
  const GeodesicReport report = solve(swing);
  if (report.geodesics.empty()) {
    EXPECT_EQ(report.reason, Reason::kLimitsInfeasible);
  } else {
    EXPECT_LE(report.geodesics[0].limit_violation, kViolation);
  }
}

// Away from the solution Newton's method on the pieces converges quadratically: its derivatives are
// right.
TEST(BoundArcs, JoinQuadratically) {
  const BoundaryValueProblem problem = parking("limit -0.3 < phi - theta < 0.3\n");
  BoundaryValueProblem unlimited = problem;
  unlimited.limits.clear();
  const Geodesic free = best(unlimited);
  const Walls walls(problem.limits, 4);
  InteriorPointOptions options;
  options.rate = free.action;
  options.sizes.assign(walls.size(), 0.3);
  options.last_mu = 1e-3;
  LimitedPath limited;
  const int intervals = 64;
  limited.path = {intervals, 4, {}, std::vector<double>(2 * intervals, 0.0), {}};
  GeodesicOptions sampled;
  sampled.samples = intervals + 1;
  const GeodesicReport report = find_geodesics(unlimited, sampled);
  for (const auto& q : report.geodesics.at(0).trajectory.q) {
    limited.path.q.insert(limited.path.q.end(), q.begin(), q.end());
  }
  const InteriorPoint solved = interior_point(problem, walls, options, limited);
  ASSERT_TRUE(solved.converged);
  EXPECT_TRUE(solved.minimum);
  auto pieces = pieces_of(problem, walls, options, limited, Contacts::kArcs, 8);
  ASSERT_TRUE(pieces);
  EXPECT_EQ(pieces->pieces.size(), 9U);
  ASSERT_TRUE(join_pieces(problem, walls, 64, *pieces));
  EXPECT_LE(pieces->residual, 1e-12);
  const BoundSurvey measured = survey_pieces(problem, walls, *pieces, 128, {0, 0.5, 1});
  ASSERT_TRUE(measured.completed);
  EXPECT_NEAR(measured.summary.action, kParking, 1e-8);
  EXPECT_EQ(measured.summary.trajectory.t.size(), 3U);
  for (const double nu : measured.least_multiplier) EXPECT_EQ(nu, 0);
}

}  // namespace
}  // namespace carnot::internal::limited_geodesics_test
