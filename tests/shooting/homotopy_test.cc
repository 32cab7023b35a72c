// Solutions that are carried along.
#include "carnot/shooting/path/homotopy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace carnot::internal::homotopy_test {
namespace {

Path number(double x) {
  Path path;
  path.dof = 1;
  path.q = {x};
  path.lambda = {0};
  return path;
}

// Newton's method for x - a s^3 = 0, that gives up where it starts too far away.
auto cubic(double a, double reach) {
  return [a, reach](double s, Path& trial) {
    const double solution = a * s * s * s;
    if (std::abs(trial.q[0] - solution) > reach) return false;
    trial.q[0] = solution;
    return true;
  };
}

TEST(Homotopy, FollowsTheSolutionToItsEnd) {
  for (const double reach : {10.0, 0.1, 1e-3}) {
    HomotopyOptions options;
    options.most_steps = 500;  // as many as the shortest reach takes
    Path path = number(0);
    EXPECT_TRUE(follow(options, cubic(2, reach), path)) << reach;
    EXPECT_EQ(path.q[0], 2) << reach;
  }
}

TEST(Homotopy, GivesUpWhereTheSolutionEnds) {
  constexpr double kEnd = 0.6;
  Path path = number(0);
  const auto correct = [](double s, Path& trial) {
    trial.q[0] = s;
    return s <= kEnd;
  };
  EXPECT_FALSE(follow({}, correct, path));
  EXPECT_LE(path.q[0], kEnd);  // the last solution
  EXPECT_GT(path.q[0], kEnd - 1e-3);
}

TEST(Homotopy, GivesUpWhereItCreeps) {
  int calls = 0;
  HomotopyOptions options;
  Path path = number(0);
  double last = 0;
  const auto correct = [&](double s, Path&) {
    ++calls;
    const bool near = s - last < 1e-4;
    if (near) last = s;
    return near;
  };
  EXPECT_FALSE(follow(options, correct, path));
  EXPECT_LE(calls, options.patience);
}

}  // namespace
}  // namespace carnot::internal::homotopy_test
