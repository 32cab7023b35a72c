#include "carnot/shooting/field/field_sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace carnot::internal::field_sample_test {
namespace {

TEST(FieldSample, PointsAreSpreadOverAllAxes) {
  FieldGrid grid;
  grid.to = {0, 0};
  std::vector<double> values(10);
  for (int i = 0; i < 10; ++i) values[i] = i;
  grid.axes = {{0, values, false, 0}, {1, values, false, 0}};
  constexpr long kCount = 20;
  const std::vector<long> points = evenly_spread_points(grid, kCount);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end());
  EXPECT_GE(points.size(), 18U);  // few fall together
  std::vector<int> in_quarter(4, 0);
  for (const long i : points) {
    ASSERT_TRUE(0 <= i && i < grid.size());
    ++in_quarter[i / 10 / 5 * 2 + i % 10 / 5];
  }
  for (const int count : in_quarter) EXPECT_GE(count, 3);
}

TEST(FieldSample, ShareOfSuccesses) {
  // With none found, (1 - share)^tried is the doubt.
  for (const long tried : {10L, 100L, 3000L}) {
    EXPECT_NEAR(upper_share(0, tried), 1 - std::pow(0.05, 1.0 / static_cast<double>(tried)), 1e-12);
  }
  EXPECT_EQ(upper_share(7, 7), 1);
  // Tables of the binomial distribution: 1 of 10, and 5 of 100.
  EXPECT_NEAR(upper_share(1, 10), 0.394, 5e-4);
  EXPECT_NEAR(upper_share(5, 100), 0.102, 5e-4);
}

}  // namespace
}  // namespace carnot::internal::field_sample_test
