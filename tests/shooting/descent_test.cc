// Ways down from discrete extremals that are no minima.
#include "carnot/shooting/path/descent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "carnot/shooting/path/discrete_equations.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/search/near_target.h"
#include "carnot/shooting/search/starts.h"
#include "shooting/problems.h"

namespace carnot::internal::descent_test {
namespace {

std::optional<Path> relaxed(const BoundaryValueProblem& problem, std::uint64_t seed, int number) {
  const auto near = NearTarget::of(problem);
  const BoundaryValueProblem easy = near ? near->easy(near->way(number)) : problem;
  Start start = make_start(easy, seed, number);
  for (int stiffer = 0; stiffer < 3; ++stiffer, start.relaxation.penalty *= 8) {
    Path path = start.path;
    relax(easy, start.relaxation, path);
    if (!tighten(easy, {}, path).converged) continue;
    if (!near || near->shrink(near->way(number), path)) return path;
  }
  return std::nullopt;
}

double action(const BoundaryValueProblem& problem, const Path& path) {
  return discrete_action(problem.dynamics, problem.time / path.intervals, path);
}

// Residual relative to the momenta.
double residual(const BoundaryValueProblem& problem, const Path& path) {
  DiscreteEquations equations(problem, path.intervals);
  std::vector<double> values;
  const double largest = equations.evaluate(path, values, nullptr);
  double worst = 0;
  for (const double value : values) worst = std::max(worst, std::abs(value));
  return worst / largest;
}

// Beside the line over which there is a continuum of extremals, some are left as saddles and some
// as minima. Going down from whatever a relaxation finds ends at one that has no way down, and no
// relaxation finds less.
void expect_ways_down_to_the_least(const BoundaryValueProblem& problem) {
  constexpr double kSolved = 1e-9;  // of a discrete extremal
  constexpr double kSame = 1e-9;
  constexpr int kStarts = 24;
  constexpr int kLongestWay = 8;
  double least = std::numeric_limits<double>::infinity();
  int saddles = 0;
  std::vector<double> ends;
  for (int i = 0; i < kStarts; ++i) {
    std::optional<Path> path = relaxed(problem, 0, i);
    if (!path) continue;
    least = std::min(least, action(problem, *path));
    for (int step = 0; step < kLongestWay; ++step) {
      const std::vector<Path> lower = ways_down(problem, *path);
      if (lower.empty()) break;
      saddles += step == 0 ? 1 : 0;
      for (const Path& one : lower) {
        EXPECT_LT(action(problem, one), action(problem, *path));
        EXPECT_LT(residual(problem, one), kSolved);
      }
      path = lower.front();
    }
    ends.push_back(action(problem, *path));
  }
  ASSERT_FALSE(ends.empty());
  EXPECT_GT(saddles, 0);
  const double lowest = *std::min_element(ends.begin(), ends.end());
  EXPECT_LE(lowest, least * (1 + kSame));
}

TEST(Descent, LeadsFromSaddlesToLess) {
  expect_ways_down_to_the_least(test::engel({2.9e-5, 6.5e-5, -5e-6, -8e-6}));
  expect_ways_down_to_the_least(test::vehicle({0, 0, 0, 0}, {-1.2e-3, -1.1e-3, 7e-4, -2.3e-3}));
}

// The constraints of a control problem are redundant, and hold the multipliers too. The target
// is so far away that round-off does not decide what a saddle is; at a tenth of it it does.
TEST(Descent, LeadsFromSaddlesOfControlProblems) {
  expect_ways_down_to_the_least(test::bicycle({0, 1e-5, 0, 0}));
}

TEST(Descent, ThereIsNoWayDownFromAMinimum) {
  const BoundaryValueProblem problem = test::straight_ahead();
  const std::optional<Path> path = relaxed(problem, 0, 0);
  ASSERT_TRUE(path);
  EXPECT_TRUE(ways_down(problem, *path).empty());
}

// Two springs, more than half a turn: the only extremal is a saddle, and the action has no minimum.
TEST(Descent, FindsNothingWhereTheActionHasNoMinimum) {
  const BoundaryValueProblem problem = test::oscillator({0, 0}, {1, 0}, 4);
  Path path;
  path.intervals = 32;
  path.dof = 2;
  for (int i = 0; i <= 32; ++i) {
    path.q.push_back(std::sin(4 * i / 32.0) / std::sin(4.0));
    path.q.push_back(0);
  }
  path.q[64] = 1;
  ASSERT_TRUE(tighten(problem, {}, path).converged);
  EXPECT_TRUE(ways_down(problem, path).empty());
}

}  // namespace
}  // namespace carnot::internal::descent_test
