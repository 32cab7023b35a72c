#include "carnot/shooting/front/enclosed.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "shooting/problems.h"

namespace carnot::internal::enclosed_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// x and y are no angles, theta is one.
Dynamics unicycle() { return test::unicycle({0, 0, 0}, {1, 0, 0}).dynamics; }

TEST(Enclosed, VolumeOfATetrahedron) {
  Surface surface;
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const std::vector<double> ends{0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 5};
  EXPECT_NEAR(enclosed_volume(unicycle(), surface, ends), 2 * 3 * 5 / 6.0, 16 * kEps);
  // The other side is the outside.
  for (auto& triangle : surface.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(enclosed_volume(unicycle(), surface, ends), 5, 16 * kEps);
}

TEST(Enclosed, AreaOfASquare) {
  Surface surface;
  surface.vertices.resize(4);
  surface.segments = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  const std::vector<double> ends{1, 1, 4, 1, 4, 3, 1, 3};
  EXPECT_NEAR(enclosed_area(unicycle(), surface, ends, false), 6, 16 * kEps);
}

// Two lines of momenta, one for each half of the border: both are followed upwards.
TEST(Enclosed, AreaBetweenTwoLines) {
  Surface surface;
  surface.vertices.resize(4);
  for (const int i : {0, 1}) surface.vertices[i].place.c = {1, 0, 0};
  for (const int i : {2, 3}) surface.vertices[i].place.c = {-1, 0, 0};
  surface.segments = {{0, 1}, {2, 3}};
  const std::vector<double> ends{1, 1, 3, 4, -1, 1, -3, 4};
  EXPECT_NEAR(enclosed_area(unicycle(), surface, ends, true), 12, 16 * kEps);
}

}  // namespace
}  // namespace carnot::internal::enclosed_test
