// Surfaces as pictures: the section, and the file.
#include "carnot/plots/surface_plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "plot_fixtures.h"

namespace carnot::plots::surface_plot_test {
namespace {

// One triangle from y = -1 to y = 1.
SurfaceSheet triangle() {
  SurfaceSheet sheet;
  sheet.points = {{0, -1, 0}, {2, 1, 0}, {0, 1, 2}};
  sheet.values = {0, 1, 2};
  sheet.triangles = {{0, 1, 2}};
  return sheet;
}

TEST(SurfacePlot, SectionsCutTrianglesHalfWay) {
  const auto pieces = section_of(triangle(), 1, 0);
  ASSERT_EQ(pieces.size(), 1U);
  EXPECT_EQ(pieces[0][0], (std::array<double, 2>{1, 0}));
  EXPECT_EQ(pieces[0][1], (std::array<double, 2>{0, 1}));
  EXPECT_TRUE(section_of(triangle(), 1, 2).empty());
}

TEST(SurfacePlot, SectionsLeaveOutWhatIsNotFinite) {
  SurfaceSheet sheet = triangle();
  sheet.points[2][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(section_of(sheet, 1, 0).empty());
}

using SurfaceFile = Directory;

// Where a sheet lies in the plane y = 0 but for round-off, ticks of y do not tell that. Where y has
// another unit it may be as small as that.
TEST_F(SurfaceFile, DoesNotShowTheRoundOffOfAPlane) {
  constexpr const char* kPowers = "×10";  // of a tick
  const auto drawn = [&](const char* unit_of_y) {
    SurfacePage page;
    page.axes = {Coordinate{"x", "length"}, Coordinate{"y", unit_of_y}, Coordinate{"z", "length"}};
    page.sheets = {triangle()};
    for (auto& point : page.sheets[0].points) point[1] *= 1e-10;
    write_surfaces(file("plane.svg"), page);
    return contents(file("plane.svg"));
  };
  EXPECT_EQ(drawn("length").find(kPowers), std::string::npos);
  EXPECT_NE(drawn("rad").find(kPowers), std::string::npos);
}

}  // namespace
}  // namespace carnot::plots::surface_plot_test
