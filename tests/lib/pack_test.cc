// Packs against plain numbers, lane by lane, in every width and with every kind of register.
#include "carnot/numerics/pack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/stumpff.h"

namespace carnot::pack_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

template <class P>
class PackTest : public ::testing::Test {
 protected:
  static constexpr int W = P::kLanes;

  static P pack(const std::array<double, W>& x) { return P::load(x.data()); }
  static std::array<double, W> numbers(const P& pack) {
    std::array<double, W> x;
    pack.store(x.data());
    return x;
  }
  // W numbers that differ in sign and size.
  static std::array<double, W> some(double scale) {
    std::array<double, W> x;
    for (int i = 0; i < W; ++i) x[i] = scale * (i % 2 == 0 ? 1 : -1) * (0.1 + 0.37 * i);
    return x;
  }
};

// Native registers, narrower ones, and none at all.
using Packs = ::testing::Types<Pack<8>, Pack<4>, Pack<2>, Pack<8, double>, Pack<16>>;
TYPED_TEST_SUITE(PackTest, Packs);

TYPED_TEST(PackTest, ComputesLaneByLane) {
  const auto x = this->some(1);
  const auto y = this->some(-3);
  const auto a = this->pack(x);
  const auto b = this->pack(y);
  const double sum_of_lanes = sum(a);
  const auto sum = this->numbers(a + b);
  const auto difference = this->numbers(a - b);
  const auto product = this->numbers(a * b);
  const auto quotient = this->numbers(a / b);
  const auto root = this->numbers(sqrt(abs(a)));
  const auto larger = this->numbers(max(a, b));
  const auto smaller = this->numbers(min(a, b));
  const auto minus = this->numbers(-a);
  const auto chosen = this->numbers(select(a < b, a, TypeParam(7)));
  const auto power = this->numbers(exp(a));
  double most = x[0];
  for (int i = 0; i < TypeParam::kLanes; ++i) {
    EXPECT_EQ(sum[i], x[i] + y[i]);
    EXPECT_EQ(difference[i], x[i] - y[i]);
    EXPECT_EQ(product[i], x[i] * y[i]);
    EXPECT_EQ(quotient[i], x[i] / y[i]);
    EXPECT_EQ(root[i], std::sqrt(std::abs(x[i])));
    EXPECT_EQ(larger[i], std::max(x[i], y[i]));
    EXPECT_EQ(smaller[i], std::min(x[i], y[i]));
    EXPECT_EQ(minus[i], -x[i]);
    EXPECT_EQ(chosen[i], x[i] < y[i] ? x[i] : 7);
    EXPECT_EQ(power[i], std::exp(x[i]));
    most = std::max(most, x[i]);
  }
  EXPECT_EQ(largest(a), most);
  // In any order: each addition rounds once, and there are fewer than lanes.
  double total = 0;
  double size = 0;
  for (const double lane : x) {
    total += lane;
    size += std::abs(lane);
  }
  EXPECT_NEAR(sum_of_lanes, total, TypeParam::kLanes * kEps * size);
}

// One lane decides.
TYPED_TEST(PackTest, MasksSeeEveryLane) {
  for (int i = 0; i < TypeParam::kLanes; ++i) {
    std::array<double, TypeParam::kLanes> x;
    x.fill(1);
    x[i] = std::nan("");
    EXPECT_FALSE(all(isfinite(this->pack(x))));
    EXPECT_FALSE(all(this->pack(x) <= TypeParam(2)));
    x[i] = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(all(isfinite(this->pack(x))));
    x[i] = 3;
    EXPECT_TRUE(all(isfinite(this->pack(x))));
    EXPECT_FALSE(all(this->pack(x) < TypeParam(2)));
    EXPECT_TRUE(any(this->pack(x) > TypeParam(2)));
    EXPECT_FALSE(any(this->pack(x) > TypeParam(4)));
  }
}

// Single errors are below an ulp; that they have no part in common, turn after turn, is what keeps
// H from drifting: correlations with sine and cosine, over random angles.
TYPED_TEST(PackTest, ErrorsOfSineAndCosineAreUnbiased) {
  using Wide = long double;
  constexpr int kPacks = 1000000 / TypeParam::kLanes;
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-4.7, 4.7);
  Wide in_phase = 0;
  Wide out_of_phase = 0;
  for (int i = 0; i < kPacks; ++i) {
    std::array<double, TypeParam::kLanes> x;
    for (double& angle : x) angle = uniform(generator);
    const auto sine = this->numbers(sin(this->pack(x)));
    const auto cosine = this->numbers(cos(this->pack(x)));
    for (int l = 0; l < TypeParam::kLanes; ++l) {
      const Wide s = std::sin(static_cast<Wide>(x[l]));
      const Wide c = std::cos(static_cast<Wide>(x[l]));
      in_phase += (sine[l] - s) * s - (cosine[l] - c) * c;
      out_of_phase += (sine[l] - s) * c + (cosine[l] - c) * s;
    }
  }
  // A thousandth of an ulp: six times the noise of the mean, a fourth of what r alone gives.
  constexpr double kBias = kEps / 1000;
  const double count = kPacks * TypeParam::kLanes;
  EXPECT_LE(std::abs(static_cast<double>(in_phase) / count), kBias);
  EXPECT_LE(std::abs(static_cast<double>(out_of_phase) / count), kBias);
}

// 2 ulp of the result, and of 1 next to a zero at a large angle, where the reduction has nothing
// more to subtract.
TYPED_TEST(PackTest, SineAndCosineAreGoodToTwoUnits) {
  std::vector<double> angles = {0, 1e-300, 1e-9, 0.5, std::numbers::pi / 4, 1, 1.5, 3, 1e3, 1e5};
  for (int k = -40; k <= 40; ++k) {
    angles.push_back(k * std::numbers::pi / 4);
    angles.push_back(std::nextafter(k * std::numbers::pi / 2, 1e9));
  }
  for (int i = 0; i < 20000; ++i) angles.push_back(-50 + 0.005 * i);
  for (const double angle : angles) {
    for (const double x : {angle, -angle}) {
      const double s = this->numbers(sin(TypeParam(x)))[0];
      const double c = this->numbers(cos(TypeParam(x)))[0];
      const double floor = std::abs(x) < 1 ? 0 : std::abs(x) * kEps;
      EXPECT_NEAR(s, std::sin(x), 2 * kEps * std::max(std::abs(std::sin(x)), floor)) << x;
      EXPECT_NEAR(c, std::cos(x), 2 * kEps * std::max(std::abs(std::cos(x)), floor)) << x;
      EXPECT_NEAR(this->numbers(tan(TypeParam(x)))[0] * c, s, 4 * kEps) << x;
    }
  }
}

TYPED_TEST(PackTest, AnglesOutOfRangeAreNotANumber) {
  if constexpr (!std::is_same_v<TypeParam, Pack<8, double>>) {
    for (const double x : {1.0000001e6, -1e7, 1e300, std::numeric_limits<double>::infinity()}) {
      EXPECT_TRUE(std::isnan(this->numbers(sin(TypeParam(x)))[0])) << x;
      EXPECT_TRUE(std::isnan(this->numbers(cos(TypeParam(x)))[0])) << x;
    }
  }
}

// Lanes on both sides of the switch from the series to the closed form, and all on one side.
TYPED_TEST(PackTest, StumpffFunctionsAgreeWithPlainOnes) {
  std::array<double, TypeParam::kLanes> near;
  std::array<double, TypeParam::kLanes> mixed;
  std::array<double, TypeParam::kLanes> far;
  for (int i = 0; i < TypeParam::kLanes; ++i) {
    near[i] = 0.9 * i / TypeParam::kLanes * kNearStumpff;
    mixed[i] = near[i] * 2;
    far[i] = 11 + 20 * near[i];
  }
  for (const auto& s : {near, mixed, far}) {
    const auto c0 = this->numbers(stumpff<0>(this->pack(s)));
    const auto c1 = this->numbers(stumpff<1>(this->pack(s)));
    const auto c2 = this->numbers(stumpff<2>(this->pack(s)));
    const auto c3 = this->numbers(stumpff<3>(this->pack(s)));
    for (int i = 0; i < TypeParam::kLanes; ++i) {
      // As for plain numbers, and the terms of the series, up to 4.2, 1.7, 1, 1.
      const double tolerance = (10 + std::sqrt(s[i])) * kEps;
      EXPECT_NEAR(c0[i], stumpff<0>(s[i]), tolerance) << s[i];
      EXPECT_NEAR(c1[i], stumpff<1>(s[i]), tolerance) << s[i];
      EXPECT_NEAR(c2[i], stumpff<2>(s[i]), tolerance) << s[i];
      EXPECT_NEAR(c3[i], stumpff<3>(s[i]), tolerance) << s[i];
    }
  }
}

// Jets over packs: d/dx of sin(x y) sqrt(y) / x.
TYPED_TEST(PackTest, CarriesDerivatives) {
  const auto x = this->some(0.3);
  Vector<TypeParam, 2> at;
  at << this->pack(x), TypeParam(2);
  const auto f = [](const auto& v) {
    using std::sin, std::sqrt;
    return sin(v[0] * v[1]) * sqrt(v[1]) / v[0];
  };
  const Vector<TypeParam, 2> slope = gradient(f, at);
  const auto by_x = this->numbers(slope[0]);
  const auto by_y = this->numbers(slope[1]);
  for (int i = 0; i < TypeParam::kLanes; ++i) {
    const Vector<double, 2> expected = gradient(f, Vector<double, 2>(x[i], 2));
    const double tolerance = 16 * kEps * (1 + expected.cwiseAbs().maxCoeff());
    EXPECT_NEAR(by_x[i], expected[0], tolerance);
    EXPECT_NEAR(by_y[i], expected[1], tolerance);
  }
}

}  // namespace
}  // namespace carnot::pack_test
