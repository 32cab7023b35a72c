#include "carnot/shooting/solve_field.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "shooting/field_axis.h"
#include "shooting/problems.h"

namespace carnot::solve_field_test {
namespace {

using test::axis;

constexpr double kPi = std::numbers::pi;

// Of the unicycle, modulo whole turns.
Field unicycles(int threads, int branches = 1) {
  FieldOptions options;
  options.search.mod_angles = true;
  options.threads = threads;
  options.branches = branches;
  options.check = 10;
  return solve_field(test::unicycle({0, 0, 0}, {0, 0, 0}),
                     {axis(0, -2, 0.25, 17), axis(1, -2, 0.25, 17), axis(2, -kPi, kPi / 9, 18)},
                     options);
}

TEST(SolveField, AgreesWithSearches) {
  constexpr double kSame = 1e-8;
  const Field field = unicycles(2);
  ASSERT_TRUE(field.finished);
  ASSERT_EQ(field.action.size(), 17U * 17 * 18);
  EXPECT_TRUE(field.settled);
  EXPECT_LT(field.sweeps, 40);
  EXPECT_EQ(field.checked, 10);
  EXPECT_EQ(field.lower, 0);
  EXPECT_EQ(field.triangles, 10);
  EXPECT_EQ(field.violations, 0);
  EXPECT_LT(field.searches, 300);
  for (std::size_t i = 0; i < field.action.size(); ++i) {
    EXPECT_EQ(field.reason[i], Reason::kNone);
    EXPECT_LE(field.error[i], 1e-10);
  }
  GeodesicOptions options;
  options.mod_angles = true;
  options.samples = 0;
  options.seed = 5;
  for (int i = 7; i < 17 * 17 * 18; i += 521) {
    const int column = i / 18 / 17;
    const int row = i / 18 % 17;
    const std::vector<double> to{-2 + 0.25 * column, -2 + 0.25 * row, -kPi + kPi / 9 * (i % 18)};
    const double action =
        find_geodesics(test::unicycle({0, 0, 0}, to), options).geodesics.at(0).action;
    EXPECT_NEAR(field.action[i], action, kSame * action) << i;
  }
}

// (x, y, theta) -> (x, -y, -theta) is a symmetry.
TEST(SolveField, HasTheSymmetriesOfTheScene) {
  const Field field = unicycles(2);
  for (int ix = 0; ix < 17; ++ix) {
    for (int iy = 0; iy < 17; ++iy) {
      for (int k = 0; k < 18; ++k) {
        const double here = field.action[(ix * 17 + iy) * 18 + k];
        const double there = field.action[(ix * 17 + 16 - iy) * 18 + (18 - k) % 18];
        EXPECT_NEAR(here, there, 1e-8 * here);
      }
    }
  }
}

// A grid of four axes, which is coarse beside what the momenta of vehicles turn in a step.
// (x, y, theta, phi) -> (x, -y, -theta, -phi) is a symmetry.
TEST(SolveField, ReachesVehicles) {
  FieldOptions options;
  options.check = 8;
  const int count = 7;
  const Field field = solve_field(test::vehicle({0, 0, 0, 0}, {0, 0, 0, 0}),
                                  {axis(0, -0.4, 0.4, 3),
                                   axis(1, -0.4, 0.4, 3),
                                   axis(2, -1.2, 0.4, count),
                                   axis(3, -1.2, 0.4, count)},
                                  options);
  ASSERT_TRUE(field.finished);
  EXPECT_EQ(field.lower, 0);
  EXPECT_EQ(field.violations, 0);
  EXPECT_LT(field.searches, 100);
  const int inside = count * count;
  for (int i = 0; i < 9 * inside; ++i) {
    EXPECT_EQ(field.reason[i], Reason::kNone);
    const int y = i / inside % 3;
    const int mirrored = i - i % inside + 2 * (1 - y) * inside + inside - 1 - i % inside;
    EXPECT_NEAR(field.action[i], field.action[mirrored], 1e-8 * field.action[i]) << i;
  }
}

TEST(SolveField, DoesNotDependOnTheNumberOfThreads) {
  const Field one = unicycles(1);
  const Field three = unicycles(3);
  EXPECT_EQ(one.action, three.action);
  EXPECT_EQ(one.p0, three.p0);
  EXPECT_EQ(one.searches, three.searches);
}

// To (0, 0, z) of the Heisenberg group a circle of area z leads: A = 2 pi |z|. The axis is
// conjugate.
TEST(SolveField, FindsTheSameWithMoreBranches) {
  constexpr double kSame = 1e-10;
  const Field one = unicycles(2, 1);
  const Field three = unicycles(2, 3);
  EXPECT_GT(three.improved, 2 * one.improved);
  for (std::size_t i = 0; i < one.action.size(); ++i) {
    EXPECT_NEAR(one.action[i], three.action[i], kSame * (1 + one.action[i])) << i;
  }
}

// Momenta of 300 move the vehicle a little back with its wheel turned, where ends of searches that
// are 1e-11 off have actions that are 1e-8 off.
TEST(SolveField, IsMoreExactThanItsSearches) {
  constexpr double kSame = 1e-10;
  const Field field = solve_field(test::vehicle({0, 0, 0, 0}, {-0.1, 0, 0, 0}),
                                  {axis(0, -0.1, -0.05, 2), axis(3, -kPi / 4, kPi / 4, 3)});
  ASSERT_TRUE(field.finished);
  for (const int row : {0, 3}) {
    EXPECT_NEAR(field.action[row], field.action[row + 2], kSame * field.action[row]);
  }
}

TEST(SolveField, ReachesTheCutLocus) {
  FieldOptions options;
  options.check = 20;
  const Field field =
      solve_field(test::heisenberg_group({0, 0, 0}),
                  {axis(0, -0.5, 0.1, 11), axis(1, -0.5, 0.1, 11), axis(2, -0.5, 0.1, 11)},
                  options);
  ASSERT_TRUE(field.finished);
  EXPECT_EQ(field.lower, 0);
  for (int k = 0; k < 11; ++k) {
    const double z = -0.5 + 0.1 * k;
    EXPECT_NEAR(field.action[(5 * 11 + 5) * 11 + k], 2 * kPi * std::abs(z), 1e-6) << z;
  }
}

// At theta = pi/2 the chart of the satellite ends: these points have their reason, wherever they
// are in the grid.
TEST(SolveField, LeavesOutPointsWhereTheSceneIsIrregular) {
  FieldOptions options;
  options.check = 0;
  const Field field = solve_field(
      test::satellite({0, 0, 0.1}), {axis(1, kPi / 2, -kPi / 6, 4), axis(0, 0, 0.1, 2)}, options);
  ASSERT_TRUE(field.finished);
  for (std::size_t i = 0; i < field.reason.size(); ++i) {
    EXPECT_EQ(field.reason[i], i < 2 ? Reason::kIrregularEnd : Reason::kNone) << i;
    EXPECT_EQ(std::isfinite(field.action[i]), i >= 2) << i;
  }
  EXPECT_THROW(solve_field(test::satellite({0, 0, 0}), {axis(1, kPi / 2, kPi, 2)}),
               std::invalid_argument);
}

// In other units the same.
TEST(SolveField, DoesNotDependOnUnits) {
  const auto field = [](double u) {
    FieldOptions options;
    options.check = 0;
    return solve_field(test::heisenberg_group({0, 0, 0}),
                       {axis(0, 0.1 * u, 0.1 * u, 4),
                        axis(1, 0.1 * u, 0.1 * u, 4),
                        axis(2, 0.1 * u * u, 0.1 * u * u, 4)},
                       options);
  };
  const Field one = field(1);
  const Field small = field(1e-3);
  for (std::size_t i = 0; i < one.action.size(); ++i) {
    EXPECT_NEAR(small.action[i] * 1e6, one.action[i], 1e-9 * one.action[i]);
  }
}

// Before every layer and block of points the work asks whether to go on.
TEST(SolveField, StopsWithinASweep) {
  for (const int patience : {40, 80, 160}) {
    std::atomic<int> asked{0};
    FieldOptions options;
    options.threads = 2;
    options.progress = [&](double) { return ++asked < patience; };
    const Field field =
        solve_field(test::unicycle({0, 0, 0}, {0, 0, 0}),
                    {axis(0, -2, 0.1, 41), axis(1, -2, 0.1, 41), axis(2, -1, 0.1, 21)},
                    options);
    EXPECT_FALSE(field.finished);
    EXPECT_LT(asked, patience + 32);  // once for each thread and slab that is left
  }
}

TEST(SolveField, StopsAndRefuses) {
  FieldOptions options;
  options.progress = [](double) { return false; };
  EXPECT_FALSE(
      solve_field(test::unicycle({0, 0, 0}, {0, 0, 0}), {axis(0, 0, 1, 5)}, options).finished);
  const BoundaryValueProblem unicycle = test::unicycle({0, 0, 0}, {0, 1, 0});
  FieldOptions none;
  none.branches = 0;
  EXPECT_THROW(solve_field(unicycle, {axis(0, 0, 1, 2)}, none), std::invalid_argument);
  EXPECT_THROW(solve_field(unicycle, {}), std::invalid_argument);
  EXPECT_THROW(solve_field(unicycle, {{0, {0, 1, 3}}}), std::invalid_argument);
  EXPECT_THROW(solve_field(unicycle, {{3, {0, 1}}}), std::invalid_argument);
  EXPECT_THROW(solve_field(test::pendulum(0, 1, 1), {axis(0, 0, 1, 2)}), std::invalid_argument);
  EXPECT_THROW(solve_field(test::vehicle_cosine({0, 0, 0, 0}, {0, 1, 0, 0}, 1), {axis(0, 0, 1, 2)}),
               std::invalid_argument);
  BoundaryValueProblem free = unicycle;
  free.free_to = {false, false, true};
  EXPECT_THROW(solve_field(free, {axis(0, 0, 1, 2)}), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::solve_field_test
