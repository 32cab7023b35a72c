// Numbers with second derivatives against Jets of Jets, which come by them in another way.
#include "carnot/numerics/second_jet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "carnot/numerics/pack.h"
#include "carnot/numerics/stumpff.h"

namespace carnot::second_jet_test {
namespace {

constexpr int kDirections = 3;
using S = SecondJet<double, kDirections>;
using J = Jet<double, kDirections>;
using JJ = Jet<J, kDirections>;
constexpr double kFew = 32 * epsilon<double>();  // of formulas of a few operations
constexpr std::array kAt = {0.4, 0.7, -1.3};

// f at the point, as a function of three variables, by both ways.
template <class F>
void expect_same(const std::string& name, const F& f) {
  std::array<S, kDirections> x;
  std::array<JJ, kDirections> y;
  for (int i = 0; i < kDirections; ++i) {
    x[i] = S(kAt[i], i);
    y[i] = JJ(J(kAt[i], i), i);
  }
  const S found = f(x[0], x[1], x[2]);
  const JJ expected = f(y[0], y[1], y[2]);
  const auto expect_close = [&](double a, double b) {
    EXPECT_NEAR(a, b, kFew * std::max(1.0, std::abs(b))) << name;
  };
  expect_close(found.a, expected.a.a);
  for (int i = 0, pair = 0; i < kDirections; ++i) {
    expect_close(found.v[i], expected.a.v[i]);
    for (int j = 0; j <= i; ++j, ++pair) expect_close(found.w[pair], expected.v[i].v[j]);
  }
}

TEST(SecondJet, ConstantsHaveNoDerivativesAndVariablesOne) {
  const S x(0.7, 1);
  EXPECT_EQ(x.a, 0.7);
  EXPECT_EQ(x.v, (std::array{0.0, 1.0, 0.0}));
  for (const S& linear : {x, S(), S(3), constant<S>(2.0)}) {
    for (const double second : linear.w) EXPECT_EQ(second, 0);
  }
  EXPECT_EQ(S(3).v, (std::array<double, 3>{}));
  EXPECT_EQ(value_of(x), 0.7);
}

TEST(SecondJet, FieldOperations) {
  expect_same("products", [](auto x, auto y, auto z) { return x * y * z + x * x - z * y; });
  expect_same("quotients", [](auto x, auto y, auto z) { return (x + y) / (z * z + 1) - y / x; });
  expect_same("reciprocals", [](auto x, auto y, auto z) { return 2 / (x * y) - 1 / z; });
  expect_same("numbers", [](auto x, auto y, auto z) {
    return 0.5 * x * y - (2 - z) / 4 + (1 + y) * 3 - (x - 1) + -z;
  });
  expect_same("in place", [](auto x, auto y, auto z) {
    x += y;
    x *= z;
    x -= 2;
    x /= y;
    return x;
  });
}

TEST(SecondJet, Functions) {
  expect_same("sqrt", [](auto x, auto y, auto z) { return sqrt(x * y + z * z); });
  expect_same("cbrt", [](auto x, auto y, auto /*z*/) { return cbrt(x + y); });
  expect_same("exp", [](auto x, auto y, auto z) { return exp(x * y - z); });
  expect_same("log", [](auto x, auto y, auto z) { return log(x + y * z * z); });
  expect_same("sin", [](auto x, auto y, auto z) { return sin(x * y) * z; });
  expect_same("cos", [](auto x, auto y, auto z) { return cos(x - y * z); });
  expect_same("tan", [](auto x, auto y, auto /*z*/) { return tan(x * y); });
  expect_same("asin", [](auto x, auto y, auto /*z*/) { return asin(x * y); });
  expect_same("acos", [](auto x, auto y, auto /*z*/) { return acos(x * y); });
  expect_same("atan", [](auto x, auto y, auto z) { return atan(x * y + z); });
  expect_same("sinh", [](auto x, auto y, auto /*z*/) { return sinh(x * y); });
  expect_same("cosh", [](auto x, auto y, auto z) { return cosh(x * z + y); });
  expect_same("tanh", [](auto x, auto y, auto z) { return tanh(x * z + y); });
  expect_same("atan2", [](auto x, auto y, auto z) { return atan2(x * y, z); });
  expect_same("hypot", [](auto x, auto y, auto z) { return hypot(x * z, y); });
  expect_same("pow of a number",
              [](auto x, auto y, auto z) { return pow(x * y, 2.5) + pow(z, 3); });
  expect_same("pow", [](auto x, auto y, auto z) { return pow(x, y * z); });
  expect_same("abs", [](auto x, auto y, auto z) { return abs(z * x) + abs(y * y); });
  expect_same("stumpff",
              [](auto x, auto y, auto z) { return stumpff<2>(x * y) + stumpff<3>(z * z); });
}

TEST(SecondJet, ComparesValues) {
  const S x(0.7, 0);
  const S y(1.3, 1);
  EXPECT_TRUE(x < y && y > x && x <= y && y >= x && x != y && x == x);
  EXPECT_TRUE(x < 1 && 1 > x && x > 0.5 && 0.5 < x && x <= 0.7 && 0.7 >= x && x == 0.7 && x != 0);
  EXPECT_FALSE(y < x || x > y || y <= x || x >= y);
  EXPECT_TRUE(isfinite(x) && !isnan(x));
  EXPECT_TRUE(isnan(sqrt(x - y)));
}

TEST(SecondJet, OfPacksAsOfDoubles) {
  using P = Pack<4>;
  const std::array<double, 4> values = {0.1, -0.4, 1.7, 3};
  const SecondJet<P, 1> x(P::load(values.data()), 0);
  const SecondJet<P, 1> y = sin(2 * x) / (1 + x * x);
  std::array<double, 4> curvature;
  y.w[0].store(curvature.data());
  for (int l = 0; l < 4; ++l) {
    const SecondJet<double, 1> one(values[l], 0);
    EXPECT_NEAR(curvature[l], (sin(2 * one) / (1 + one * one)).w[0], kFew);
  }
}

}  // namespace
}  // namespace carnot::second_jet_test
