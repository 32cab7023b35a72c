// The discrete Lagrangian of paths: derivatives, the midpoint rule, and one route against another.
#include "carnot/shooting/path/path_lagrangian.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/drift.h"
#include "shooting/drift_problems.h"
#include "shooting/problems.h"
#include "shooting/tight_path.h"

namespace carnot::internal::path_lagrangian_test {
namespace {

using Terms = PathLagrangian::Terms;

Path wavy(const Dynamics& dynamics, int intervals) {
  Path path;
  path.intervals = intervals;
  path.dof = dynamics.dof;
  for (int i = 0; i < (intervals + 1) * dynamics.dof; ++i) path.q.push_back(1 + std::sin(0.3 * i));
  const int multipliers = PathLagrangian::multipliers(dynamics);
  for (int i = 0; i < intervals * multipliers; ++i) path.lambda.push_back(std::cos(0.7 * i));
  return path;
}

std::vector<double> list(const PathLagrangian::Numbers& numbers) {
  std::vector<double> all;
  for (int i = 0; i < numbers.size(); ++i) all.push_back(numbers[i]);
  return all;
}

TEST(PathLagrangian, DerivativesAreThoseOfF) {
  // More intervals than are evaluated at once.
  const Dynamics dynamics = test::literature("van-der-pol");
  const int n = dynamics.dof;
  constexpr double kH = 0.1;
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-8;  // of central differences with this step
  PathLagrangian lagrangian(dynamics, kH);
  Path path = wavy(dynamics, 11);
  constexpr int kInterval = 9;
  std::vector<double> gradient, hessian;
  lagrangian.visit(path, true, [&](int i, const Terms& terms) {
    if (i != kInterval) return;
    gradient = list(terms.gradient);
    hessian = list(terms.hessian);
  });
  const auto gradient_with = [&](int a, double by) {
    Path moved = path;
    (a < 2 * n ? moved.q[kInterval * n + a] : moved.lambda[kInterval * n + a - 2 * n]) += by;
    std::vector<double> result;
    lagrangian.visit(moved, false, [&](int i, const Terms& terms) {
      EXPECT_EQ(terms.hessian.size(), 0);
      if (i == kInterval) result = list(terms.gradient);
    });
    return result;
  };
  for (int a = 0; a < 3 * n; ++a) {
    const std::vector<double> ahead = gradient_with(a, kStep);
    const std::vector<double> back = gradient_with(a, -kStep);
    for (int b = 0; b < 3 * n; ++b) {
      EXPECT_NEAR((ahead[b] - back[b]) / (2 * kStep), hessian[b * 3 * n + a], kTolerance);
    }
  }
}

TEST(PathLagrangian, DriftWithoutMomentumIsAnExtremal) {
  const Dynamics dynamics = test::literature("kepler-transfer");
  constexpr double kH = 0.05;
  constexpr int kIntervals = 40;
  const auto nodes = drift_nodes(dynamics, 1, {1, 0, 0, 1}, 0, kH, kIntervals);
  ASSERT_EQ(nodes.size(), kIntervals + 1U);
  Path path;
  path.intervals = kIntervals;
  path.dof = 4;
  for (const auto& q : nodes) path.q.insert(path.q.end(), q.begin(), q.end());
  path.lambda.assign(4 * kIntervals, 0.0);
  PathLagrangian lagrangian(dynamics, kH);
  constexpr double kRoundOff = 1e-14;
  lagrangian.visit(path, false, [&](int, const Terms& terms) {
    for (const double x : list(terms.gradient)) EXPECT_NEAR(x, 0, kRoundOff);
  });
  EXPECT_EQ(lagrangian.action(path), 0);
}

// The vehicle has a transcription of its own. Without it, its discrete extremals are the same.
TEST(PathLagrangian, BothTranscriptionsHaveTheSameExtremals) {
  const BoundaryValueProblem own = test::sideways();
  BoundaryValueProblem other = own;
  other.dynamics.transcription = nullptr;
  Path path = test::tight_path(own);
  const int n = path.dof;
  const double h = own.time / path.intervals;
  Path phase = path;
  phase.lambda.resize(path.intervals * n);
  // The momentum in the middle of an interval is the mean of those at its ends.
  for (int i = 0; i < path.intervals; ++i) {
    for (int j = 0; j < n; ++j) {
      phase.lambda[i * n + j] = 0.5 * (path.momentum(i)[j] + path.momentum(i + 1)[j]);
    }
  }
  EXPECT_NEAR(discrete_action(other.dynamics, h, phase),
              discrete_action(own.dynamics, h, path),
              1e-8 * discrete_action(own.dynamics, h, path));
  ASSERT_TRUE(tighten(other, {}, phase).converged);
  constexpr double kTight = 1e-8;  // what Newton's method left, times the condition
  for (std::size_t j = 0; j < path.q.size(); ++j) {
    EXPECT_NEAR(phase.q[j], path.q[j], kTight);
    EXPECT_NEAR(phase.p[j], path.p[j], kTight * (1 + std::abs(path.p[j])));
  }
}

}  // namespace
}  // namespace carnot::internal::path_lagrangian_test
