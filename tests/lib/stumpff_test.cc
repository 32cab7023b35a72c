#include "carnot/numerics/stumpff.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/numerics/gradient.h"

namespace carnot::stumpff_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long double kWideEps = std::numeric_limits<long double>::epsilon();

// Zero, next to zero, both sides of the switch from series to closed form, and large.
const std::vector<double> kHardValues = {
    0, 1e-300, 1e-16, 1e-8, 1e-3, 0.5, 1 - 1e-15, 1, 1 + 1e-15, 1.5, 9.869604401089358, 50, 1e3};

// The closed forms in long double; c_k(0) = 1/k!.
long double exact(int k, long double s) {
  const long double r = std::sqrt(s);
  if (k == 0) return std::cos(r);
  if (s < 0.01L) {  // six terms of the series reach 1e-19 here
    long double factorial = 1;
    for (int i = 2; i <= k; ++i) factorial *= i;
    long double term = 1 / factorial;
    long double sum = term;
    for (int j = 1; j < 8; ++j) {
      term *= -s / ((2 * j + k - 1) * (2 * j + k));
      sum += term;
    }
    return sum;
  }
  if (k == 1) return std::sin(r) / r;
  if (k == 2) return 2 * std::pow(std::sin(r / 2), 2) / s;
  return (1 - std::sin(r) / r) / s;  // k == 3
}

// cos and sin of r = sqrt(s) carry the rounding of r, r eps / 2; the rest is a few roundings of
// numbers up to 1.
double tolerance(double s) { return (4 + std::sqrt(s)) * kEps; }

TEST(StumpffTest, AgreesWithTheClosedForms) {
  for (const double s : kHardValues) {
    EXPECT_NEAR(stumpff<0>(s), static_cast<double>(exact(0, s)), tolerance(s)) << s;
    EXPECT_NEAR(stumpff<1>(s), static_cast<double>(exact(1, s)), tolerance(s)) << s;
    EXPECT_NEAR(stumpff<2>(s), static_cast<double>(exact(2, s)), tolerance(s)) << s;
    EXPECT_NEAR(stumpff<3>(s), static_cast<double>(exact(3, s)), tolerance(s)) << s;
  }
}

TEST(StumpffTest, LongDoubleIsAsAccurateForItself) {
  for (const double s : kHardValues) {
    const long double wide = s;
    const auto allowed = static_cast<double>((4 + std::sqrt(wide)) * kWideEps);
    EXPECT_NEAR(static_cast<double>(stumpff<0>(wide) - exact(0, wide)), 0, allowed) << s;
    EXPECT_NEAR(static_cast<double>(stumpff<1>(wide) - exact(1, wide)), 0, allowed) << s;
    EXPECT_NEAR(static_cast<double>(stumpff<2>(wide) - exact(2, wide)), 0, allowed) << s;
  }
}

TEST(StumpffTest, ValuesAtZeroAreReciprocalFactorials) {
  EXPECT_EQ(stumpff<0>(0.0), 1.0);
  EXPECT_EQ(stumpff<1>(0.0), 1.0);
  EXPECT_EQ(stumpff<2>(0.0), 0.5);
  EXPECT_EQ(stumpff<3>(0.0), 1.0 / 6);
  EXPECT_EQ(stumpff<4>(0.0), 1.0 / 24);
}

// s c_{k+2} = 1/k! - c_k.
TEST(StumpffTest, RecurrenceLinksTheFunctions) {
  for (const double s : kHardValues) {
    EXPECT_NEAR(s * stumpff<2>(s), 1 - stumpff<0>(s), 2 * tolerance(s)) << s;
    EXPECT_NEAR(s * stumpff<3>(s), 1 - stumpff<1>(s), 2 * tolerance(s)) << s;
    EXPECT_NEAR(s * stumpff<4>(s), 0.5 - stumpff<2>(s), 2 * tolerance(s)) << s;
    EXPECT_NEAR(s * stumpff<5>(s), 1.0 / 6 - stumpff<3>(s), 2 * tolerance(s)) << s;
  }
}

// No jump where the series hands over to cos and sin.
TEST(StumpffTest, IsContinuousAtTheSwitch) {
  const double below = std::nextafter(1.0, 0.0);
  EXPECT_NEAR(stumpff<0>(below), stumpff<0>(1.0), tolerance(1));
  EXPECT_NEAR(stumpff<1>(below), stumpff<1>(1.0), tolerance(1));
  EXPECT_NEAR(stumpff<2>(below), stumpff<2>(1.0), tolerance(1));
  EXPECT_NEAR(stumpff<3>(below), stumpff<3>(1.0), tolerance(1));
}

// d cos r / ds = -sin(r) / (2 r);  d (sin r / r) / ds = (cos r - sin r / r) / (2 s).
TEST(StumpffTest, DerivativeOnJets) {
  using J = Jet<double, 1>;
  for (const double s : kHardValues) {
    const J x(s, 0);
    const auto by_s = static_cast<double>(exact(3, s) - exact(2, s)) / 2;
    EXPECT_NEAR(stumpff<0>(x).v[0], -static_cast<double>(exact(1, s)) / 2, tolerance(s)) << s;
    EXPECT_NEAR(stumpff<1>(x).v[0], by_s, tolerance(s)) << s;
    EXPECT_EQ(stumpff<0>(x).a, stumpff<0>(s));
    EXPECT_EQ(stumpff<1>(x).a, stumpff<1>(s));
  }
}

// The chain rule: two directions with any seeds.
TEST(StumpffTest, JetsScaleTheirSeeds) {
  using J = Jet<double, 2>;
  const J x(0.7, Vector<double, 2>(3, -5));
  const double slope = stumpff<1>(J(0.7, 0)).v[0];
  EXPECT_DOUBLE_EQ(stumpff<1>(x).v[0], 3 * slope);
  EXPECT_DOUBLE_EQ(stumpff<1>(x).v[1], -5 * slope);
}

// c_0'' = (sin r / r - cos r) / (4 s), 1/12 at s = 0.
TEST(StumpffTest, SecondDerivativeOnNestedJets) {
  using J = Jet<Jet<double, 1>, 1>;
  for (const double s : kHardValues) {
    J x;
    x.a = Jet<double, 1>(s, 0);
    x.v[0] = Jet<double, 1>(1.0);
    const auto second = static_cast<double>(exact(2, s) - exact(3, s)) / 4;
    EXPECT_NEAR(stumpff<0>(x).v[0].v[0], second, tolerance(s)) << s;
  }
}

// cos|x| in the plane, through the origin: gradient -sin(r) x / r, Hessian -I at 0. Written with
// sqrt it has no derivative there.
TEST(StumpffTest, MakesEvenFunctionsOfADistanceSmooth) {
  using Inner = Jet<double, 2>;
  using Outer = Jet<Inner, 2>;
  const Vector<Outer, 2> x = seeded(seeded(Vector<double, 2>(0, 0)));
  const Outer value = stumpff<0>(Outer(x[0] * x[0] + x[1] * x[1]));
  EXPECT_EQ(value.a.a, 1.0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(value.v[i].a, 0.0);
    for (int j = 0; j < 2; ++j) EXPECT_EQ(value.v[i].v[j], i == j ? -1.0 : 0.0);
  }
}

TEST(StumpffTest, NotANumberStaysNotANumber) {
  EXPECT_TRUE(std::isnan(stumpff<0>(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(stumpff<1>(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace carnot::stumpff_test
