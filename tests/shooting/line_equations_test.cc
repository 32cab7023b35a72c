// The Jacobian of the extended equations against differences.
#include "carnot/shooting/continue/line_equations.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shooting/problems.h"

namespace carnot::internal::line_equations_test {
namespace {

// A central difference: eps^(2/3) of round-off and truncation, magnified by the growth of the flow.
constexpr double kStep = 1e-5;
constexpr double kDifference = 1e-6;

void expect_derivatives(const ProblemLine& line, int segments, double s) {
  constexpr long kSteps = 32;
  const std::vector<double> p0{1.2, -0.7, 0.4};
  const Knots knots = knots_of(line.at(s), p0, segments, kSteps);
  LineEquations equations(line, knots, s, kSteps);
  // Off the solution, so that no term vanishes.
  Eigen::VectorXd x = equations.unknowns(knots, s);
  for (Eigen::Index i = 0; i + 1 < x.size(); ++i) x[i] += 0.01 * std::sin(1.0 + double(i));
  Eigen::VectorXd residual;
  Eigen::VectorXd after;
  Eigen::VectorXd before;
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd unused;
  ASSERT_TRUE(equations.evaluate(x, residual, jacobian));
  ASSERT_EQ(jacobian.rows(), equations.size());
  ASSERT_EQ(jacobian.cols(), equations.size() + 1);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Eigen::VectorXd aside = kStep * Eigen::VectorXd::Unit(x.size(), i);
    ASSERT_TRUE(equations.evaluate(x + aside, after, unused));
    ASSERT_TRUE(equations.evaluate(x - aside, before, unused));
    const Eigen::VectorXd difference = (after - before) / (2 * kStep);
    EXPECT_LE((difference - jacobian.col(i)).cwiseAbs().maxCoeff(), kDifference) << i;
  }
}

TEST(LineEquations, JacobiansAreThoseOfDifferences) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  const std::vector<ProblemLine> lines{moving_target(problem, {2, 1, 1}),
                                       moving_start(problem, {0.3, -0.2, 1}),
                                       moving_time(problem, 3)};
  for (const ProblemLine& line : lines) {
    for (const int segments : {1, 4}) {
      // Near the ends the nodes of the derivative in s are one-sided.
      for (const double s : {1e-4, 0.4, 1 - 1e-4}) expect_derivatives(line, segments, s);
    }
  }
}

TEST(LineEquations, DoNotLeaveTheLine) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 0});
  const ProblemLine line = moving_time(problem, 3);
  const Knots knots = knots_of(problem, {1, 1, 1}, 1, 32);
  LineEquations equations(line, knots, 0, 32);
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  EXPECT_TRUE(equations.evaluate(equations.unknowns(knots, 0), residual, jacobian));
  EXPECT_FALSE(equations.evaluate(equations.unknowns(knots, -0.01), residual, jacobian));
  EXPECT_FALSE(equations.evaluate(equations.unknowns(knots, 1.01), residual, jacobian));
}

}  // namespace
}  // namespace carnot::internal::line_equations_test
