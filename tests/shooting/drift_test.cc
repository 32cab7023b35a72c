// Motion without controls: order, reversal, scale, and where it ends.
#include "carnot/shooting/path/drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shooting/drift_problems.h"

namespace carnot::internal::drift_test {
namespace {

double miss_on_the_circle(int steps) {
  const Dynamics kepler = test::literature("kepler-transfer");
  constexpr double kTime = 2;
  const auto nodes = drift_nodes(kepler, 1, {1, 0, 0, 1}, 0, kTime / steps, steps);
  return std::hypot(nodes.back()[0] - std::cos(kTime), nodes.back()[1] - std::sin(kTime));
}

TEST(Drift, IsOfSecondOrder) {
  const double coarse = miss_on_the_circle(50);
  const double fine = miss_on_the_circle(100);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.02);
}

TEST(Drift, RunsBackwards) {
  const Dynamics dynamics = test::literature("van-der-pol");
  const auto ahead = drift_nodes(dynamics, 0.7, {1, 0.5}, 0, 0.05, 30);
  const auto back = drift_nodes(dynamics, 0.7, ahead.back(), 1.5, -0.05, 30);
  constexpr double kRoundOff = 1e-10;  // magnified by the way back, which is unstable
  EXPECT_NEAR(back.back()[0], 1, kRoundOff);
  EXPECT_NEAR(back.back()[1], 0.5, kRoundOff);
}

TEST(Drift, AtHalfItsSpeedTakesTwiceTheTime) {
  const Dynamics dynamics = test::literature("van-der-pol");
  const auto slow = drift_nodes(dynamics, 0.5, {1, 0.5}, 0, 0.1, 20);
  const auto fast = drift_nodes(dynamics, 1, {1, 0.5}, 0, 0.05, 20);
  constexpr double kRoundOff = 1e-13;
  for (int j = 0; j < 2; ++j) EXPECT_NEAR(slow.back()[j], fast.back()[j], kRoundOff);
}

TEST(Drift, EndsWhereItCannotBeFollowed) {
  // x' = x^2 reaches infinity at t = 1.
  const Dynamics dynamics =
      test::from_text("coordinates x\ncontrols u\nx' = x^2 + u\ncost = u^2 / 2\n");
  const auto nodes = drift_nodes(dynamics, 1, {1}, 0, 0.05, 100);
  EXPECT_GT(nodes.size(), 10U);
  EXPECT_LT(nodes.size(), 25U);
  for (const auto& q : nodes) EXPECT_TRUE(std::isfinite(q[0]));
}

}  // namespace
}  // namespace carnot::internal::drift_test
