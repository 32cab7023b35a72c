// The curve of solutions by its laws, on extremals of the Heisenberg group in closed form.
#include "carnot/shooting/continue/solution_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::internal::solution_curve_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFold = 4.493409457909064;  // tan s = s, see continuation_test.cc
constexpr double kSolved = 1e-12;            // of F, whose scale is one

// The second extremal to (1/2, 0, 1/2), while the target falls to (1/2, 0, 0): it meets a fold.
struct SolutionCurveTest : testing::Test {
  BoundaryValueProblem problem = test::heisenberg_group({0.5, 0, 0.5});
  ProblemLine line = moving_target(problem, {0.5, 0, 0});
  Knots knots = knots_of(problem, second(), 1, 64);
  LineEquations equations{line, knots, 0, 64};
  SolutionCurve curve{equations};
  VectorXd up = VectorXd::Unit(equations.size() + 1, equations.size());  // towards larger s
  CurvePoint first = curve.start(equations.unknowns(knots, 0), up).value();

  [[nodiscard]] std::vector<double> second() const {
    GeodesicOptions options;
    options.count = 2;
    return find_geodesics(problem, options).geodesics.at(1).p0;
  }
  void expect_on_curve(const CurvePoint& point) {
    VectorXd residual;
    MatrixXd jacobian;
    ASSERT_TRUE(equations.evaluate(point.x, residual, jacobian));
    EXPECT_LE(residual.norm(), kSolved);
    EXPECT_NEAR(point.tangent.norm(), 1, 1e-14);
    EXPECT_LE((jacobian * point.tangent).norm(), kSolved);
  }
  // A few steps along the curve, until the tangent has turned back.
  std::pair<CurvePoint, CurvePoint> about_the_fold() {
    CurvePoint here = first;
    for (int i = 0; i < 200; ++i) {
      const auto next = curve.correct(here.x + 0.02 * here.tangent, here.tangent, here.tangent);
      if (!next) break;
      if (next->slope() < 0) return {here, *next};
      here = *next;
    }
    ADD_FAILURE() << "no fold";
    return {first, first};
  }
};

TEST_F(SolutionCurveTest, StartsOnTheCurveInTheDirectionAskedFor) {
  expect_on_curve(first);
  EXPECT_GT(first.slope(), 0);
  const CurvePoint back = curve.start(first.x, -up).value();
  EXPECT_LE((back.tangent + first.tangent).norm(), 1e-9);
}

TEST_F(SolutionCurveTest, CorrectsInThePlaneItIsGiven) {
  const VectorXd predicted = first.x + 0.03 * first.tangent;
  const auto point = curve.correct(predicted, first.tangent, first.tangent);
  ASSERT_TRUE(point);
  expect_on_curve(*point);
  EXPECT_NEAR(first.tangent.dot(point->x - predicted), 0, kSolved);
  EXPECT_GT(point->tangent.dot(first.tangent), 0.9);
  EXPECT_EQ(point->orientation, first.orientation);
  EXPECT_LT(point->contraction, 0.1) << "Newton's method converges quadratically";
}

TEST_F(SolutionCurveTest, FarFromTheCurveThereIsNothing) {
  const VectorXd far = first.x + VectorXd::Constant(first.x.size(), 30);
  EXPECT_FALSE(curve.correct(far, first.tangent, first.tangent));
  EXPECT_FALSE(curve.start(far, up)) << "s is outside [0, 1]";
}

TEST_F(SolutionCurveTest, LocatesAValueOfS) {
  const auto next = curve.correct(first.x + 0.05 * first.tangent, first.tangent, first.tangent);
  ASSERT_TRUE(next);
  const double s = 0.3 * next->s();
  const VectorXd x = curve.locate(first, *next, [&](const CurvePoint& at) { return at.s() - s; });
  EXPECT_NEAR(x[x.size() - 1], s, 1e-10);
}

TEST_F(SolutionCurveTest, LocatesTheFold) {
  const auto [before, after] = about_the_fold();
  const VectorXd fold =
      curve.locate(before, after, [](const CurvePoint& at) { return at.slope(); });
  EXPECT_NEAR(fold[fold.size() - 1], 1 - 0.125 * kFold, 1e-10);
  EXPECT_NEAR(equations.head(fold)[2], 2 * kFold, 1e-7);
}

TEST_F(SolutionCurveTest, ThereIsNoTouchOnARegularPiece) {
  const auto next = curve.correct(first.x + 0.05 * first.tangent, first.tangent, first.tangent);
  ASSERT_TRUE(next);
  EXPECT_FALSE(curve.locate_touch(first, *next));
}

// A pendulum at rest is stationary for every T; from T = pi on it may also swing.
TEST(SolutionCurve, TheOtherDirectionLeavesTheBranchPoint) {
  const BoundaryValueProblem problem = test::pendulum(0, 0, 2);
  const ProblemLine line = moving_time(problem, 5);
  const double s = (std::numbers::pi - 2) / 3;
  const Knots rest = knots_of(line.at(s), {0}, 1, 64);
  LineEquations equations(line, rest, s, 64);
  SolutionCurve curve(equations);
  const auto swing = curve.other_direction(equations.unknowns(rest, s), Eigen::Vector2d(0, 1));
  ASSERT_TRUE(swing);
  EXPECT_NEAR(std::abs((*swing)[0]), 1, 1e-12);
  EXPECT_NEAR((*swing)[1], 0, 1e-12);
}

// Steering in place with an abnormal covector: momenta along it move nothing.
TEST(SolutionCurve, DoesNotStartWhereTheJacobianLacksRank) {
  const BoundaryValueProblem problem = test::vehicle({0, 0, 0, 0}, {0, 0, 0, 1});
  const ProblemLine line = moving_target(problem, {0, 0, 0, 2});
  const Knots knots = knots_of(problem, {0, 0, 0, 1}, 1, 32);
  LineEquations equations(line, knots, 0, 32);
  SolutionCurve curve(equations);
  const VectorXd x = equations.unknowns(knots, 0);
  EXPECT_FALSE(curve.start(x, VectorXd::Unit(x.size(), x.size() - 1)));
}

}  // namespace
}  // namespace carnot::internal::solution_curve_test
