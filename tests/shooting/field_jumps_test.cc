#include "carnot/shooting/field/field_jumps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace carnot::internal::field_jumps_test {
namespace {

constexpr int kCount = 21;

FieldGrid square() {
  FieldGrid grid;
  grid.to = {0, 0};
  std::vector<double> values(kCount);
  constexpr int kMiddle = kCount / 2;
  for (int i = 0; i < kCount; ++i) values[i] = 0.1 * (i - kMiddle);
  grid.axes = {{0, values, false, 0}, {1, values, false, 0}};
  return grid;
}

std::vector<double> euclidean(const FieldGrid& grid) {
  std::vector<double> distances;
  for (long i = 0; i < grid.size(); ++i) {
    const std::vector<double> q = grid.target(i);
    distances.push_back(std::hypot(q[0], q[1]));
  }
  return distances;
}

TEST(FieldJumps, AreNoneOfADistance) {
  EXPECT_TRUE(points_beyond_jumps(square(), euclidean(square())).empty());
}

TEST(FieldJumps, TheFarthestPointComesFirst) {
  std::vector<double> distances = euclidean(square());
  const long far = 3 * kCount + 5;
  const long farther = 12 * kCount + 17;
  distances[far] += 1;
  distances[farther] += 2;
  EXPECT_EQ(points_beyond_jumps(square(), distances), (std::vector<long>{farther, far}));
}

// Nothing is said beside points that are not known.
TEST(FieldJumps, PointsThatAreNotKnownAreLeftOut) {
  std::vector<double> distances = euclidean(square());
  distances[3 * kCount + 5] = std::numeric_limits<double>::infinity();
  distances[12 * kCount + 17] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(points_beyond_jumps(square(), distances).empty());
}

// It cannot be told which of two is wrong; the farther one is searched.
TEST(FieldJumps, OfAPointThatIsTooNearItsNeighboursAreMeant) {
  std::vector<double> distances = euclidean(square());
  distances[3 * kCount + 5] -= 1;
  EXPECT_EQ(points_beyond_jumps(square(), distances).size(), 4U);
}

}  // namespace
}  // namespace carnot::internal::field_jumps_test
