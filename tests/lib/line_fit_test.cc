#include "carnot/numerics/line_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carnot::line_fit_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(LineFitTest, IsExactOnALine) {
  const LineFit fit = fit_line({0, 1, 2, 4}, {1, 3, 5, 9});
  EXPECT_DOUBLE_EQ(fit.slope, 2);
  EXPECT_DOUBLE_EQ(fit.correlation, 1);
  EXPECT_LE(fit.standard_error, 10 * kEps);
  EXPECT_EQ(fit.points, 4);
  EXPECT_TRUE(std::isnan(fit_line({1}, {1}).slope));
}

}  // namespace
}  // namespace carnot::line_fit_test
