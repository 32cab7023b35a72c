#include "carnot/shooting/field/triangles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/shooting/solve_field.h"
#include "shooting/problems.h"

namespace carnot::internal::triangles_test {
namespace {

// A field of unicycles, modulo whole turns.
struct TrianglesTest : testing::Test {
  const BoundaryValueProblem problem = test::unicycle({0, 0, 0}, {0, 0, 0});
  FieldGrid grid;
  Field field;
  GeodesicOptions search;

  void SetUp() override {
    constexpr double kPi = std::numbers::pi;
    std::vector<double> length;
    std::vector<double> angle;
    for (int i = 0; i < 7; ++i) length.push_back(-1.5 + 0.5 * i);
    for (int i = 0; i < 12; ++i) angle.push_back(-kPi + kPi / 6 * i);
    grid = {{0, 0, 0}, {{0, length, false, 0}, {1, length, false, 0}, {2, angle, true, 2 * kPi}}};
    search.mod_angles = true;
    FieldOptions options;
    options.search = search;
    options.check = 0;
    field = solve_field(problem, {{0, length}, {1, length}, {2, angle}}, options);
    ASSERT_TRUE(field.finished && field.settled);
  }
  // Every so manieth point.
  [[nodiscard]] std::vector<long> every(long stride) const {
    std::vector<long> points;
    for (long i = 0; i < grid.size(); i += stride) points.push_back(i);
    return points;
  }
  [[nodiscard]] Triangles check(const std::vector<long>& points) const {
    const FieldTeam nobody;
    FieldPartners alone(nobody);
    return check_triangles(
        problem, grid, [this](long i) { return field.action[i]; }, points, search, 3, 2, alone);
  }
};

TEST_F(TrianglesTest, HoldInAField) {
  const Triangles triangles = check(every(17));
  EXPECT_EQ(triangles.tried, (grid.size() + 16) / 17);
  EXPECT_TRUE(triangles.beyond.empty());
}

// A quarter of the points as far again as they are: what is told to be too far is among them, and
// some of it is told.
TEST_F(TrianglesTest, TellASpoiltField) {
  for (long i = 0; i < grid.size(); i += 4) field.action[i] *= 4;
  const Triangles triangles = check(every(17));
  EXPECT_GE(triangles.beyond.size(), 4U);
  for (const long i : triangles.beyond) EXPECT_EQ(i % 4, 0) << i;
}

TEST_F(TrianglesTest, LeavesOutWhatIsNotKnown) {
  for (double& action : field.action) action = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(check(every(17)).tried, 0);
}

}  // namespace
}  // namespace carnot::internal::triangles_test
