// The ladder of masses: where it stands, its rungs, and the way down.
#include "carnot/shooting/problem/mass_ladder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/path/discrete_equations.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/search/relaxed_start.h"
#include "shooting/problems.h"

namespace carnot::internal::mass_ladder_test {
namespace {

const std::vector<double> kTarget{1, 1, 0.5, 0.2};

// Of a vehicle that is made with this inertia of the steered wheel.
std::vector<double> residual_with(double beta, const Path& path) {
  return residual_of(test::light_steering(kTarget, beta), path);
}

// A path that is no extremal.
Path wiggle(int intervals) {
  Path path = make_start(test::light_steering(kTarget, 1), 0, 1, intervals).path;
  path.lambda.assign(2 * intervals, 0.0);
  for (std::size_t i = 0; i < path.lambda.size(); ++i)
    path.lambda[i] = std::sin(static_cast<double>(i + 1));
  return path;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

TEST(MassLadder, StandsWhereSomethingLightMovesFreely) {
  const BoundaryValueProblem light = test::light_steering(kTarget, 1e-3);
  const MassLadder ladder(light);
  EXPECT_EQ(ladder.height(), 5);  // 1e-3 4^5 > 1
  EXPECT_EQ(&ladder.on(0), &light);
}

TEST(MassLadder, HasNoRungsElsewhere) {
  EXPECT_EQ(MassLadder(test::sideways()).height(), 0);
  // The heading is light, but the wheels tie it to the way.
  const BoundaryValueProblem tied(test::vehicle_with_alpha(1e-4), {0, 0, 0, 0}, kTarget);
  EXPECT_EQ(MassLadder(tied).height(), 0);
  EXPECT_EQ(MassLadder(test::heisenberg_group({0, 0, 1})).height(), 0) << "no mass at all";
  EXPECT_EQ(MassLadder(test::falling_cat({0.1, 0.2, 0.3})).height(), 0) << "a gauge";
  EXPECT_EQ(MassLadder(test::pendulum(0, 1, 1)).height(), 0) << "no transcription";
}

// The rungs are the scene itself with another parameter, in all that paths ask of it.
TEST(MassLadder, RungsAreTheSceneWithMoreMass) {
  constexpr double kBeta = 1e-3;
  constexpr double kRoundOff = 1e-12;  // of momenta of up to 100
  const BoundaryValueProblem problem = test::light_steering(kTarget, kBeta);
  const MassLadder ladder(problem);
  const Path path = wiggle(20);  // two whole packs of intervals and a part of one
  for (int rung = 0; rung <= ladder.height(); ++rung) {
    const double beta = std::min(1.0, kBeta * std::pow(4, rung));
    const BoundaryValueProblem made = test::light_steering(kTarget, beta);
    const BoundaryValueProblem& on_rung = ladder.on(rung);
    expect_near(residual_of(on_rung, path), residual_with(beta, path), kRoundOff);
    EXPECT_NEAR(discrete_action(on_rung.dynamics, 1.0 / 20, path),
                discrete_action(made.dynamics, 1.0 / 20, path),
                kRoundOff);
    // Newton's method takes the second derivatives; the terms of relaxation are these.
    std::vector<double> terms(4 + 2 + 1), slopes(terms.size() * 8);
    std::vector<double> terms_made(terms.size()), slopes_made(slopes.size());
    const std::vector<double> v{1, 2, 3, 4};
    ASSERT_TRUE(on_rung.dynamics.midpoint(kTarget, v, terms, slopes));
    ASSERT_TRUE(made.dynamics.midpoint(kTarget, v, terms_made, slopes_made));
    expect_near(terms, terms_made, kRoundOff);
    expect_near(slopes, slopes_made, kRoundOff);
  }
}

TEST(MassLadder, LeadsDownWithoutGaps) {
  constexpr double kRoundOff = 1e-12;
  const BoundaryValueProblem problem = test::light_steering(kTarget, 1e-3);
  const MassLadder ladder(problem);
  const Path path = wiggle(8);
  for (int rung = 1; rung <= ladder.height(); ++rung) {
    const auto below = [&](double share) { return residual_of(ladder.below(rung, share), path); };
    expect_near(below(0), residual_of(ladder.on(rung), path), kRoundOff);
    expect_near(below(0.5), residual_with(1e-3 * std::pow(4, rung - 0.5), path), kRoundOff);
    expect_near(below(1), residual_of(ladder.on(rung - 1), path), kRoundOff);
  }
}

// The layers of a path last as many intervals on a finer grid that begins on a lower rung.
TEST(MassLadder, FinerGridsBeginLower) {
  const BoundaryValueProblem problem = test::light_steering(kTarget, 1e-3);
  const MassLadder ladder(problem);
  std::vector<int> begun(ladder.height() + 1, 0);
  for (int start = 0; start < 9; ++start) {
    const int rung = ladder.rung_of(start, 16);
    ++begun[rung];
    EXPECT_EQ(ladder.rung_of(start, 32), std::max(0, rung - 1));
    EXPECT_EQ(ladder.rung_of(start, 1024), 0);
  }
  EXPECT_EQ(begun[0], 3) << "a third of all starts";
  EXPECT_EQ(begun[ladder.height()], 3);
  EXPECT_EQ(begun[ladder.height() - 1], 3);
  const BoundaryValueProblem easy = test::sideways();
  EXPECT_EQ(MassLadder(easy).rung_of(0, 16), 0);
}

// On the lowest rung for a grid the root of the least mass lasts 16 intervals, of a time of one.
TEST(MassLadder, KnowsTheLowestRungForAGrid) {
  constexpr double kBeta = 1e-3;
  const BoundaryValueProblem problem = test::light_steering(kTarget, kBeta);
  const MassLadder ladder(problem);
  for (const int intervals : {16, 24, 64, 100, 256, 500, 512, 4096}) {
    const auto is_enough = [&](int rung) {
      return std::sqrt(std::min(1.0, kBeta * std::pow(4, rung))) * intervals >= 16;
    };
    const int rung = ladder.rung_for(intervals);
    EXPECT_TRUE(is_enough(rung)) << intervals;
    if (rung > 0) {
      EXPECT_FALSE(is_enough(rung - 1)) << intervals;
    }
  }
}

// What begins on the ladder ends as an extremal of the problem itself, on grids that err by h^2.
TEST(MassLadder, RefinedPathsAreOfTheProblemItself) {
  constexpr double kTightened = 1e-9;
  const BoundaryValueProblem problem = test::light_steering(kTarget, 1e-3);
  const MassLadder ladder(problem);
  const std::vector<StartDraw> first{{0, 16}};
  const RelaxedStart start = relaxed_starts(ladder, std::nullopt, {}, first)[0];
  ASSERT_TRUE(start.found);
  ASSERT_EQ(start.path.rung, ladder.height());
  RefinementOptions options;
  options.enough = 0;
  options.max_intervals = 2048;
  const Refinement refined = refine(ladder, options, start.path);
  ASSERT_TRUE(refined.found);
  EXPECT_EQ(refined.finer.back().rung, 0);
  double largest = 0;
  for (const double p : refined.finer.back().p) largest = std::max(largest, std::abs(p));
  for (const double left : residual_of(problem, refined.finer.back())) {
    EXPECT_NEAR(left, 0, kTightened * largest);
  }
  const auto action_of = [&](std::size_t from_last) {
    const Path& path = refined.finer[refined.finer.size() - from_last];
    return discrete_action(problem.dynamics, 1.0 / path.intervals, path);
  };
  EXPECT_NEAR((action_of(3) - action_of(2)) / (action_of(2) - action_of(1)), 4, 0.2);
}

// With masses to zero the action falls to that of free steering, by a layer at each end: its width,
// and what it costs, are in proportion to the root of the mass.
TEST(MassLadder, LayersCostTheRootOfTheMass) {
  constexpr double kHigherOrder = 0.1;  // of the ratio 2
  const auto solve = [](double beta) {
    const GeodesicReport report = find_geodesics(test::light_steering(kTarget, beta));
    EXPECT_TRUE(!report.geodesics.empty()) << beta;
    EXPECT_LT(report.starts, 60) << beta;
    return !report.geodesics.empty() ? report.geodesics.front().action : 0;
  };
  const double thick = solve(4e-4);
  const double middle = solve(1e-4);
  const double thin = solve(2.5e-5);
  EXPECT_NEAR((thick - middle) / (middle - thin), 2, kHigherOrder);
}

// Sideways parking with light steering, which has layers in the middle, too: each action is below
// that of a heavier wheel, and none is an artefact of its grid.
TEST(MassLadder, LighterWheelsParkWithLessAction) {
  double last = 22.707881803770334;  // with beta = 1
  for (const double beta : {1e-1, 1e-2}) {
    const GeodesicReport report = find_geodesics(test::light_steering({0, 1, 0, 0}, beta));
    ASSERT_TRUE(!report.geodesics.empty());
    EXPECT_LT(report.geodesics.front().action, last);
    last = report.geodesics.front().action;
  }
}

}  // namespace
}  // namespace carnot::internal::mass_ladder_test
