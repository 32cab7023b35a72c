#include "carnot/tableau/collocation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carnot::collocation_test {
namespace {

constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

TEST(LegendreTest, ClosedForms) {
  constexpr long double kTolerance = 8 * kWideEps;  // a few roundings of terms up to 4
  for (const long double x : {-1.0L, -0.7L, 0.0L, 0.3L, 1.0L}) {
    const auto p = legendre(4, x);
    const long double xx = x * x;
    EXPECT_EQ(p[0], 1);
    EXPECT_EQ(p[1], x);
    EXPECT_NEAR(static_cast<double>(p[2] - (3 * xx - 1) / 2), 0, kTolerance);
    EXPECT_NEAR(static_cast<double>(p[3] - x * (5 * xx - 3) / 2), 0, kTolerance);
    EXPECT_NEAR(static_cast<double>(p[4] - (35 * xx * xx - 30 * xx + 3) / 8), 0, kTolerance);
    EXPECT_EQ(p[5], 0) << "beyond the degree asked for";
  }
}

// Two Gauss nodes, where the integrals of the two Lagrange polynomials are known.
TEST(CollocationTest, MuOfTwoNodes) {
  const long double root = std::sqrt(1.0L / 3);
  const auto first = legendre(2, -root);
  const auto second = legendre(2, root);
  const long double offset = std::sqrt(3.0L) / 3;  // a_12 = 1/4 - sqrt(3)/6, b = 1/2
  constexpr long double kTolerance = 8 * kWideEps;
  EXPECT_NEAR(static_cast<double>(collocation_mu(first, first, 1) - 0.5L), 0, kTolerance);
  EXPECT_NEAR(
      static_cast<double>(collocation_mu(first, second, 1) - (0.5L - offset)), 0, kTolerance);
  EXPECT_NEAR(
      static_cast<double>(collocation_mu(second, first, 1) - (0.5L + offset)), 0, kTolerance);
}

TEST(CollocationTest, RoundedWithComplement) {
  for (int i = -40; i <= 60; ++i) {
    const long double x = std::sin(static_cast<long double>(i)) + i / 10.0L;
    const auto rounded = rounded_with_complement<double>(x);
    const double complement = 1 - rounded;
    EXPECT_EQ(rounded + complement, 1) << i;
    EXPECT_EQ(static_cast<long double>(rounded) + complement, 1) << i << ": exact";
    EXPECT_NEAR(rounded, static_cast<double>(x), 8 * std::numeric_limits<double>::epsilon());
  }
}

TEST(NewtonRootTest, SquareRootOfTwo) {
  const long double root = newton_root(1.41L, [](long double x) { return (x * x - 2) / (2 * x); });
  EXPECT_NEAR(static_cast<double>(root - std::sqrt(2.0L)), 0, 2 * kWideEps);
}

}  // namespace
}  // namespace carnot::collocation_test
