#include "carnot/numerics/scalar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carnot::scalar_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Scalar, TheLargerAndTheSmallerOfNumbers) {
  EXPECT_EQ(maximum(1.0, 2.0), 2);
  EXPECT_EQ(maximum(2.0, 1.0), 2);
  EXPECT_EQ(maximum(-kInfinity, 1.0), 1);
  EXPECT_EQ(minimum(1.0, 2.0), 1);
  EXPECT_EQ(minimum(2.0, 1.0), 1);
  EXPECT_EQ(minimum(kInfinity, 1.0), 1);
}

// Whichever of them it is: a number that comes later does not hide it.
TEST(Scalar, ANumberThatIsNoneComesOut) {
  for (const double other : {0.0, -1.0, kInfinity, -kInfinity, kNan}) {
    EXPECT_TRUE(std::isnan(maximum(kNan, other)));
    EXPECT_TRUE(std::isnan(maximum(other, kNan)));
    EXPECT_TRUE(std::isnan(minimum(kNan, other)));
    EXPECT_TRUE(std::isnan(minimum(other, kNan)));
  }
}

}  // namespace
}  // namespace carnot::scalar_test
