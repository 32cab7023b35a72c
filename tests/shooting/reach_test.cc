// What controls reach along the drift.
#include "carnot/shooting/problem/reach.h"

#include <gtest/gtest.h>

#include "shooting/drift_problems.h"

namespace carnot::internal::reach_test {
namespace {

constexpr double kGrid = 1e-3;  // relative; sizes need no more

TEST(Reach, IsTheGramianOfADoubleIntegrator) {
  // W = (t^3/3, t^2/2; t^2/2, t); nothing turns.
  for (const double time : {0.5, 4.0}) {
    const Reach reach = reach_of({test::double_integrator(), {0, 0}, {1, 0}, time});
    EXPECT_NEAR(reach.sizes[0], time * time / 3, kGrid * time * time);
    EXPECT_NEAR(reach.sizes[1], 1, kGrid);
    EXPECT_EQ(reach.turns, 0);
    EXPECT_EQ(reach.rest, (std::vector<double>{0, 0}));
  }
}

// A unicycle cannot move sideways, but it can where it has turned: on the mean by sin^2.
TEST(Reach, SeesWhatOtherPointsCanMove) {
  const Dynamics unicycle = test::from_text(
      "coordinates x, y [length], theta [angle]\n"
      "lagrangian = (x'^2 + y'^2 + theta'^2) / 2\n0 = x' sin(theta) - y' cos(theta)\n");
  constexpr double kSampled = 0.1;  // by 64 points
  const Reach reach = reach_of({unicycle, {0, 0, 0}, {0, 1, 0}});
  EXPECT_NEAR(reach.sizes[0], 1, kGrid);
  EXPECT_NEAR(reach.sizes[1], 0.5, kSampled);
  EXPECT_NEAR(reach.sizes[2], 1, kGrid);
}

TEST(Reach, CountsTheTurnsOfAnOscillator) {
  const Dynamics oscillator =
      test::from_text("coordinates x, v\ncontrols u\nx' = 3 v\nv' = u - 3 x\ncost = u^2 / 2\n");
  const Reach reach = reach_of({oscillator, {1, 0}, {0, 0}, 10});
  constexpr double kAbout = 0.03;  // relative: the 16th root of a mean of 16th powers
  EXPECT_NEAR(reach.turns, 30, 30 * kAbout);
}

TEST(Reach, CountsTurnsInAnyUnits) {
  // An oscillator beside a slower one, at a place in units u.
  constexpr double kRoundOff = 1e-12;
  const auto turns = [](double u) {
    const std::string unit = std::to_string(u);
    const Dynamics dynamics = test::from_text(
        "coordinates x, v, y, w\ncontrols a, b\nlet unit = " + unit +
        "\nx' = 3 unit v\nv' = a - 3 x / unit + y / (10 unit)\ny' = unit w\nw' = b - y / unit\n"
        "cost = (a^2 + b^2) / 2\n");
    return reach_of({dynamics, {u, 0, 0, 0}, {0, 0, u, 0}, 10}).turns;
  };
  const double reference = turns(1);
  EXPECT_GT(reference, 0.8 * 30);
  EXPECT_LT(reference, 30);
  for (const double u : {0.001, 1000.0, 1e6}) {
    EXPECT_NEAR(turns(u), reference, reference * kRoundOff) << u;
  }
}

TEST(Reach, DoesNotDependOnUnits) {
  // Metres and centimetres.
  const std::string head = "coordinates x, v\ncontrols u\nv' = u\ncost = u^2 / 2\n";
  const Dynamics metres = test::from_text(head + "x' = v\n");
  const Dynamics centimetres = test::from_text(head + "x' = 100 v\n");
  const Reach a = reach_of({metres, {0, 0}, {1, 0}, 2});
  const Reach b = reach_of({centimetres, {0, 0}, {100, 0}, 2});
  EXPECT_NEAR(b.sizes[0], 1e4 * a.sizes[0], kGrid * b.sizes[0]);
  EXPECT_NEAR(b.sizes[1], a.sizes[1], kGrid);
}

TEST(Reach, ReplacesARestThatDoesNotExist) {
  // H = |p| has no derivative without momentum.
  const Dynamics dynamics =
      test::from_text("coordinates x, y\nlagrangian = -sqrt(1 - x'^2 - y'^2)\n");
  const Reach regular = reach_of({dynamics, {0, 0}, {0.3, 0.4}, 1});
  EXPECT_EQ(regular.rest, (std::vector<double>{0, 0}));
  const std::vector<double> p = straight_momentum({dynamics, {0, 0}, {0.3, 0.4}, 1});
  constexpr double kRoundOff = 1e-14;
  EXPECT_NEAR(p[0], 0.3 / std::sqrt(0.75), kRoundOff);
  EXPECT_NEAR(p[1], 0.4 / std::sqrt(0.75), kRoundOff);
}

}  // namespace
}  // namespace carnot::internal::reach_test
