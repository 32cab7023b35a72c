// Sewing: partners become vertices of the border, wherever they are.
#include "carnot/shooting/front/seam.h"

#include <gtest/gtest.h>

#include <vector>

namespace carnot::internal::seam_test {
namespace {

SurfaceVertex at(double x, double y) { return {{Eigen::Vector3d(x, y, 0)}, {}}; }

// The partners of two vertices are beyond one end of an edge, so that its end is nearest to both.
TEST(Seam, TakesPartnersBeyondOneEndOfAnEdge) {
  Surface surface{{at(0, 0), at(1, 0), at(0, 1)}, {{0, 1, 2}}, {}};
  const std::vector<BorderVertex> border{{0, false, {Eigen::Vector3d(2, -0.5, 0)}},
                                         {2, false, {Eigen::Vector3d(3, -0.5, 0)}}};
  std::vector<int> partners_of;
  const std::vector<int> classes = sew(
      border,
      [&](int first, const std::vector<int>& of) {
        EXPECT_EQ(first, 3);
        partners_of = of;
      },
      surface);
  EXPECT_EQ(partners_of, (std::vector<int>{0, 2}));
  ASSERT_EQ(surface.vertices.size(), 5U);
  EXPECT_EQ(surface.triangles.size(), 3U);  // a fan over the two new vertices
  EXPECT_EQ(classes, (std::vector<int>{0, 1, 2, 0, 2}));
}

}  // namespace
}  // namespace carnot::internal::seam_test
