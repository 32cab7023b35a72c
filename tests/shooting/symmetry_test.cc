#include "carnot/shooting/extremal/symmetry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/problem/origin.h"
#include "carnot/shooting/problem/problem_line.h"
#include "shooting/problems.h"

namespace carnot::internal::symmetry_test {
namespace {

constexpr double kPi = std::numbers::pi;

// Polishes p0 and checks that every symmetry maps the extremal to an extremal of equal action.
void expect_partners(const BoundaryValueProblem& problem,
                     const std::vector<double>& p0,
                     std::size_t symmetries) {
  constexpr double kTolerance = 1e-10;
  const auto extremal = verify(problem, knots_of(problem, p0, 8, 32), 32, kTolerance).extremal;
  ASSERT_TRUE(extremal);
  const std::vector<ProblemSymmetry> list = symmetries_of(problem);
  EXPECT_EQ(list.size(), symmetries);
  for (const ProblemSymmetry& symmetry : list) {
    const Knots image = partner(problem.dynamics.info, symmetry, extremal->knots);
    const auto other = verify(problem, image, 32, kTolerance).extremal;
    ASSERT_TRUE(other);
    const double action = extremal->geodesic.action;
    EXPECT_NEAR(other->geodesic.action, action, 1e-10 * action);
    const Knots back = partner(problem.dynamics.info, symmetry, image);
    for (int j = 0; j < extremal->knots.dof; ++j) {  // each is its own inverse
      EXPECT_NEAR(back.p0()[j], extremal->knots.p0()[j], 1e-9);
    }
  }
}

// H does not depend on the coordinates that may be moved, and does on others.
TEST(Symmetry, MovableCoordinatesLeaveTheHamiltonianAlone) {
  constexpr double kRoundOff = 1e-14;
  for (const BoundaryValueProblem& problem : {test::sideways(),
                                              test::bicycle({0, 1, 0, 0}),
                                              test::grushin({0, 0}, {0, 1}),
                                              test::martinet({0, 0, 1}),
                                              test::engel({0, 0, 0, 1}),
                                              test::heisenberg_group({0, 0, 1}),
                                              test::satellite({1, 0, 0})}) {
    const Dynamics& dynamics = problem.dynamics;
    const std::vector<int> movable_ones = movable(dynamics.info);
    EXPECT_FALSE(movable_ones.empty());
    std::vector<double> q{0.3, 0.4, 0.2, 0.1};
    std::vector<double> p{0.7, -0.3, 1.1, 0.4};
    q.resize(dynamics.dof);
    p.resize(dynamics.dof);
    std::vector<double> velocity(dynamics.dof), lambda(dynamics.multipliers);
    const auto energy = [&](const std::vector<double>& at) {
      return dynamics.evaluate(0, at, p, velocity, lambda).hamiltonian;
    };
    for (int j = 0; j < dynamics.dof; ++j) {
      std::vector<double> moved = q;
      moved[j] += 0.37;
      const bool is_movable =
          std::find(movable_ones.begin(), movable_ones.end(), j) != movable_ones.end();
      const double change = std::abs(energy(moved) - energy(q));
      EXPECT_EQ(change <= kRoundOff * energy(q), is_movable) << dynamics.info.name << " " << j;
    }
  }
}

TEST(Symmetry, SidewaysIsReversedAndMirrored) {
  expect_partners(test::sideways(), {-5.3631314, 16.1843774, -9.3116147, -4.0807579}, 1);
}

TEST(Symmetry, TurningRoundUsesRotations) {
  expect_partners(test::vehicle({0, 0, 0, 0}, {0, 0, kPi, kPi}),
                  {7.97378122, -4.6773758, 3.66867891, 2.99756799},
                  1);
}

TEST(Symmetry, TheStraightLineHasAll) {
  expect_partners(test::straight_ahead(), {1, 0, 0, 0}, 1);  // the mirror keeps both ends
}

TEST(Symmetry, WhatIsNearlySymmetricIsNot) {
  constexpr double kBeside = 1e-8;
  EXPECT_EQ(symmetries_of(test::vehicle({0, 0, 0, 0}, {0, 1, 0, 0})).size(), 1U);
  EXPECT_EQ(symmetries_of(test::vehicle({0, 0, 0, 0}, {0, 1, kBeside, 0})).size(), 0U);
}

TEST(Symmetry, AGeneralProblemHasNone) {
  expect_partners(test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.7}), {2.12, -0.27, 1.17, 1.38}, 0);
}

}  // namespace
}  // namespace carnot::internal::symmetry_test
