// Less action, smaller defects: one step where the problem is convex, more where it is not.
#include "carnot/shooting/path/action_descent.h"

#include <gtest/gtest.h>

#include <cmath>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/path_lagrangian.h"
#include "carnot/shooting/problem/reach.h"
#include "shooting/drift_problems.h"

namespace carnot::internal::action_descent_test {
namespace {

Path straight(const BoundaryValueProblem& problem, int intervals) {
  Path path;
  path.intervals = intervals;
  path.dof = problem.dynamics.dof;
  for (int i = 0; i <= intervals; ++i) {
    const double s = static_cast<double>(i) / intervals;
    for (int j = 0; j < path.dof; ++j) {
      path.q.push_back((1 - s) * problem.from[j] + s * problem.to[j]);
    }
  }
  return path;
}

ActionDescentOptions options_for(const BoundaryValueProblem& problem, double relaxation) {
  const Reach reach = reach_of(problem);
  ActionDescentOptions options;
  options.sizes = reach.sizes;
  options.rest = reach.rest;
  options.relaxation = relaxation;
  return options;
}

double action_of(const BoundaryValueProblem& problem, const Path& path) {
  return discrete_action(problem.dynamics, problem.time / path.intervals, path);
}

TEST(ActionDescent, SolvesAConvexProblemAtOnce) {
  const BoundaryValueProblem problem = test::regulator(10);
  Path path = straight(problem, 200);
  path.lambda.assign(400, 0.0);
  const ActionDescent descent = reduce_action(problem, options_for(problem, 0), path);
  EXPECT_TRUE(descent.converged);
  EXPECT_LE(descent.iterations, 2);
  // It is a discrete extremal, whose action has an error of order h^2.
  EXPECT_TRUE(tighten(problem, {}, path).converged);
  EXPECT_NEAR(action_of(problem, path), 1 + std::sqrt(0.5), 1e-3);
}

TEST(ActionDescent, AFictitiousControlMakesEveryPathAdmissible) {
  // The dearer it is, the higher the action of the rest.
  const BoundaryValueProblem problem = test::swing_up();
  double last = 0;
  for (const double relaxation : {100.0, 10.0, 1.0, 0.1}) {
    Path path = straight(problem, 64);
    const ActionDescent descent = reduce_action(problem, options_for(problem, relaxation), path);
    EXPECT_TRUE(descent.converged) << relaxation;
    double cost = 0;
    PathLagrangian lagrangian(problem.dynamics, problem.time / 64);
    lagrangian.visit(path, false, [&](int i, const PathLagrangian::Terms&) {
      cost += path.lambda[2 * i + 1] * path.lambda[2 * i + 1];
    });
    EXPECT_GT(cost, last);
    last = cost;
  }
}

TEST(ActionDescent, TheMethodOfMultipliersTakesTheFictitiousControlBack) {
  const BoundaryValueProblem problem = test::regulator(2);
  constexpr int kIntervals = 64;
  Path exact = straight(problem, kIntervals);
  exact.lambda.assign(2 * kIntervals, 0.0);
  ASSERT_TRUE(reduce_action(problem, options_for(problem, 0), exact).converged);
  Path path = straight(problem, kIntervals);
  ActionDescentOptions options = options_for(problem, 0.1);
  options.tolerance = 1e-9;
  const auto apart = [&] {
    double largest = 0;
    for (std::size_t k = 0; k < path.q.size(); ++k) {
      largest = std::max(largest, std::abs(path.q[k] - exact.q[k]));
    }
    return largest;
  };
  constexpr double kContracts = 0.8;
  constexpr double kLeft = 1e-5;  // what the tolerance of the exact one leaves
  double last = 1;
  for (int round = 0; round < 40 && last > kLeft; ++round) {
    ASSERT_TRUE(reduce_action(problem, options, path).converged) << round;
    options.centre = path.lambda;
    EXPECT_LT(apart(), kContracts * last) << round;
    last = apart();
  }
  EXPECT_LE(last, kLeft);
}

TEST(ActionDescent, FindsAMinimumAndNoSaddle) {
  // From many paths of the swing-up the action is that of one of the five minima on this grid.
  const BoundaryValueProblem problem = test::swing_up();
  for (const double bend : {-6.0, -3.0, 3.0, 6.0}) {
    Path path = straight(problem, 128);
    for (int i = 0; i <= 128; ++i) path.configuration(i)[0] += bend * std::sin(3 * i / 128.0);
    path.configuration(128)[0] = problem.to[0];
    ActionDescentOptions options = options_for(problem, 0.3);
    (void)reduce_action(problem, options, path);
    options.relaxation = 0;
    ASSERT_TRUE(reduce_action(problem, options, path).converged) << bend;
    const double action = action_of(problem, path);
    double nearest = 1;
    for (const double known : {0.6704512, 1.0889021, 5.4657512, 13.5804919, 25.7376041}) {
      nearest = std::min(nearest, std::abs(action / known - 1));
    }
    EXPECT_LT(nearest, 0.02) << action;
  }
}

TEST(ActionDescent, SaysWhereAPathCannotBeEvaluated) {
  // The straight line passes the planet.
  const BoundaryValueProblem problem{
      test::literature("kepler-transfer"), {1, 0, 0, 1}, {-1, 0, 0, -1}, 3};
  Path path = straight(problem, 31);
  for (int j = 0; j < 2; ++j) path.configuration(15)[j] = path.configuration(16)[j] = 0;
  const ActionDescent descent = reduce_action(problem, options_for(problem, 1), path);
  EXPECT_FALSE(descent.converged);
  EXPECT_EQ(path.lambda.size(), 4 * 31U);
}

}  // namespace
}  // namespace carnot::internal::action_descent_test
