#include "carnot/shooting/warm_start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "carnot/shooting/find_geodesics.h"
#include "shooting/problems.h"

namespace carnot::warm_start_test {
namespace {

constexpr double kTolerance = 1e-10;

// Targets around that of the problem, `away` in each coordinate and along diagonals.
std::vector<std::vector<double>> targets_around(const std::vector<double>& to, double away) {
  std::vector<std::vector<double>> targets;
  for (std::size_t j = 0; j < to.size(); ++j) {
    for (const double sign : {1.0, -1.0}) {
      targets.push_back(to);
      targets.back()[j] += sign * away;
      targets.push_back(targets.back());
      targets.back()[(j + 1) % to.size()] += 0.7 * away;
    }
  }
  return targets;
}

// A problem, and how far away from its target others may be.
class WarmStartTest : public ::testing::TestWithParam<std::pair<BoundaryValueProblem, double>> {};

TEST_P(WarmStartTest, ReachesTargetsNearby) {
  const auto& [problem, farthest] = GetParam();
  GeodesicOptions options;
  options.samples = 0;
  const Geodesic near = find_geodesics(problem, options).geodesics.at(0);
  const WarmStart start(problem, near.p0, kTolerance);
  ASSERT_TRUE(start.ready());
  const std::size_t n = problem.to.size();
  std::vector<double> p0(n);
  for (const double away : {0.0, 1e-2 * farthest, 0.1 * farthest, farthest}) {
    for (const std::vector<double>& to : targets_around(problem.to, away)) {
      const WarmStartReport report = start.solve(to.data(), p0.data());
      ASSERT_TRUE(report.converged) << away << ' ' << report.endpoint_error;
      EXPECT_LE(report.flows, away < farthest ? 8 : 12);
      // The same branch, and an end that another integration confirms.
      double moved = 0;
      for (std::size_t j = 0; j < n; ++j) moved = std::max(moved, std::abs(p0[j] - near.p0[j]));
      EXPECT_LE(moved, 100 * away + kTolerance);
      std::vector<double> z = problem.from;
      z.insert(z.end(), p0.begin(), p0.end());
      const StepPlan plan = StepPlan::equal(0, problem.time, near.plan.count);
      ASSERT_TRUE(problem.dynamics.flow(plan, z).completed());
      for (std::size_t j = 0; j < n; ++j) EXPECT_NEAR(z[j], to[j], 2 * kTolerance);
    }
  }
}

// Parking is the least linear: |dq(T)/dp0|^-1 is about 100.
INSTANTIATE_TEST_SUITE_P(Scenes,
                         WarmStartTest,
                         ::testing::Values(std::pair(test::sideways(), 1e-2),
                                           std::pair(test::vehicle({0, 0, 0, 0}, {2, 1, 0.5, 0.5}),
                                                     1e-2),
                                           std::pair(test::unicycle({0, 0, 0}, {1, 1, 1}), 1e-2),
                                           std::pair(test::unicycle({3, 1, 2}, {3, 2, 2}), 1e-2),
                                           std::pair(test::heisenberg_group({1, 0, 0.2}), 1e-2)));

TEST(WarmStart, LeavesTheMomentumWhereTheTargetIsFar) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 1});
  GeodesicOptions options;
  options.samples = 0;
  const Geodesic near = find_geodesics(problem, options).geodesics.at(0);
  const WarmStart start(problem, near.p0, kTolerance);
  const std::vector<double> far{-20, 30, 40};
  std::vector<double> p0(3);
  EXPECT_FALSE(start.solve(far.data(), p0.data()).converged);
  EXPECT_EQ(p0, near.p0);
}

TEST(WarmStart, IsNotReadyWhereThereIsNothingToInvert) {
  const double pi = std::numbers::pi;
  const BoundaryValueProblem circle = test::heisenberg_group({0, 0, 1});
  const std::vector<double> conjugate{2 * std::sqrt(pi), 0, 2 * pi};
  EXPECT_FALSE(WarmStart(circle, conjugate).ready());
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 1});
  const std::vector<double> astray{1, 2, 3};
  const WarmStart start(problem, astray);
  EXPECT_FALSE(start.ready());
  std::vector<double> p0(3);
  EXPECT_FALSE(start.solve(problem.to.data(), p0.data()).converged);
  EXPECT_EQ(p0, astray);
}

TEST(WarmStart, BadInputIsRefused) {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(WarmStart(problem, {1, 2}), std::invalid_argument);
  EXPECT_THROW(WarmStart(problem, {1, 2, 3}, 0), std::invalid_argument);
  EXPECT_THROW(WarmStart(test::unicycle({0, 0}, {1, 1, 1}), {1, 2, 3}), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::warm_start_test
