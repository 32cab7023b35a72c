#include "carnot/shooting/symmetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "carnot/shooting/verification.h"
#include "shooting/problems.h"

namespace carnot {
namespace {

constexpr double kPi = std::numbers::pi;

// Polishes p0 and checks that every symmetry maps the extremal to an extremal of equal action.
void expect_partners(const BoundaryValueProblem& problem,
                     const std::vector<double>& p0,
                     std::size_t symmetries) {
  constexpr double kTolerance = 1e-10;
  const auto extremal = verify(problem, knots_of(problem, p0, 8, 32), 32, kTolerance);
  ASSERT_TRUE(extremal);
  const std::vector<ProblemSymmetry> list = symmetries_of(problem);
  EXPECT_EQ(list.size(), symmetries);
  for (const ProblemSymmetry& symmetry : list) {
    const Knots image = partner(problem.segment.info, symmetry, extremal->knots);
    const auto other = verify(problem, image, 32, kTolerance);
    ASSERT_TRUE(other);
    const double action = extremal->geodesic.action;
    EXPECT_NEAR(other->geodesic.action, action, 1e-10 * action);
    const Knots back = partner(problem.segment.info, symmetry, image);
    for (int j = 0; j < extremal->knots.dof; ++j) {  // each is its own inverse
      EXPECT_NEAR(back.p0()[j], extremal->knots.p0()[j], 1e-9);
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

TEST(Symmetry, AGeneralProblemHasNone) {
  expect_partners(test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.7}), {2.12, -0.27, 1.17, 1.38}, 0);
}

}  // namespace
}  // namespace carnot
