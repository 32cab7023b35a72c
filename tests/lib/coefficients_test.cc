#include "carnot/numerics/coefficients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <type_traits>

namespace carnot::coefficients_test {
namespace {

constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

static_assert(std::is_same_v<Wider<double>, long double>);
static_assert(std::is_same_v<Wider<long double>, long double>);

TEST(DecimalTest, ReadsToRoundOff) {
  EXPECT_EQ(decimal<double>("0.5"), 0.5);
  EXPECT_EQ(decimal<double>("-12.25"), -12.25);
  EXPECT_EQ(decimal<double>("17"), 17.0);
  EXPECT_EQ(decimal<double>("-0.0"), 0.0);
  const auto relative = [](long double x, long double exact) {
    return static_cast<double>(std::abs(x / exact - 1) / kWideEps);
  };
  constexpr double kUnits = 2;
  EXPECT_LE(relative(decimal<long double>("0.333333333333333333333333333333"), 1.0L / 3), kUnits);
  EXPECT_LE(relative(decimal<long double>("-43.4898841810699588477366255144"),
                     -43.4898841810699588477366255144L),
            kUnits);
  EXPECT_LE(relative(decimal<long double>("0.00827378916381402288758473766002"),
                     0.00827378916381402288758473766002L),
            kUnits);
}

}  // namespace
}  // namespace carnot::coefficients_test
