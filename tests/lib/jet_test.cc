// Dual numbers: each function against its derivative, by identities and by a second level of Jets.
#include "carnot/numerics/jet.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "carnot/numerics/pack.h"
#include "carnot/numerics/scalar.h"

namespace carnot::jet_test {
namespace {

using J = Jet<double, 2>;
using JJ = Jet<J, 2>;
constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kFew = 16 * kEps;  // of formulas of a few operations on numbers of order 1

J variable(double value, int direction) { return {value, direction}; }
JJ second(double value, int direction) { return {J(value, direction), direction}; }

void expect_near(const J& x, const J& y) {
  EXPECT_NEAR(x.a, y.a, kFew);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(x.v[i], y.v[i], kFew);
}

TEST(Jet, ConstantsHaveNoDerivativesAndVariablesOne) {
  const J zero = J();
  EXPECT_EQ(zero.a, 0);
  EXPECT_EQ(zero.v[0], 0);
  EXPECT_EQ(zero.v[1], 0);
  const J three = 3;
  EXPECT_EQ(three.a, 3);
  EXPECT_EQ(three.v[1], 0);
  const J x = variable(0.7, 1);
  EXPECT_EQ(x.v[0], 0);
  EXPECT_EQ(x.v[1], 1);
}

TEST(Jet, FieldOperations) {
  const J x = variable(0.7, 0);
  const J y = variable(-1.3, 1);
  expect_near((x + y) * (x - y), x * x - y * y);
  expect_near(x / y * y, x);
  expect_near(1 / (1 / x), x);
  const J product = x * y;
  EXPECT_EQ(product.v[0], -1.3);
  EXPECT_EQ(product.v[1], 0.7);
  const J ratio = x / y;
  EXPECT_NEAR(ratio.v[0], 1 / -1.3, kFew);
  EXPECT_NEAR(ratio.v[1], -0.7 / (1.3 * 1.3), kFew);
  expect_near(-x + x, J(0));
}

// Numbers of C++ mix with Jets of any depth, on both sides.
TEST(Jet, MixesWithNumbers) {
  const J x = variable(0.7, 0);
  expect_near(0.5 * x, x / 2);
  expect_near(2 - x, -(x - 2));
  expect_near(x + 1, 1 + x);
  expect_near(3 / x, J(3) / x);
  J sum = x;
  sum += 1;
  sum *= 2;
  sum -= x;
  sum /= 4.0f;
  expect_near(sum, (x + 2) / 4);
  const JJ xx = second(0.7, 0);
  const JJ half = 0.5 * xx * xx + 1 - xx / 3;
  EXPECT_NEAR(half.v[0].a, 0.7 - 1.0 / 3, kFew);
  EXPECT_NEAR(half.v[0].v[0], 1, kFew);
  const Jet<long double, 1> wide(0.7L, 0);
  EXPECT_EQ((0.5 * wide).v[0], 0.5L);
}

TEST(Jet, ComparesValues) {
  const J x = variable(0.7, 0);
  const J y = variable(1.3, 1);
  EXPECT_TRUE(x < y && y > x && x <= y && y >= x && x != y && x == x);
  EXPECT_TRUE(x < 1 && 1 > x && x > 0.5 && 0.5 < x && x <= 0.7 && 0.7 >= x && x == 0.7 && x != 0);
  EXPECT_FALSE(y < x || x > y || y <= x || x >= y);
  EXPECT_EQ(abs(-x).v[0], 1);
  EXPECT_EQ(abs(x).v[0], 1);
  EXPECT_EQ(abs(variable(-0.7, 0)).v[0], -1);
}

struct Function {
  std::string name;
  std::function<JJ(const JJ&)> of;
  std::function<double(double)> value;
  std::function<double(double)> slope;
  std::function<double(double)> curvature;
  double at = 0.4;
};

std::vector<Function> functions() {
  using std::acos, std::asin, std::atan, std::cbrt, std::cos, std::cosh, std::exp, std::log;
  using std::pow, std::sin, std::sinh, std::sqrt, std::tan, std::tanh;
  const auto square = [](double x) { return x * x; };
  return {
      {"sqrt",
       [](const JJ& x) { return sqrt(x); },
       [](double x) { return sqrt(x); },
       [](double x) { return 0.5 / sqrt(x); },
       [](double x) { return -0.25 / (x * sqrt(x)); }},
      {"cbrt",
       [](const JJ& x) { return cbrt(x); },
       [](double x) { return cbrt(x); },
       [](double x) { return 1 / (3 * pow(x, 2.0 / 3)); },
       [](double x) { return -2 / (9 * pow(x, 5.0 / 3)); }},
      {"exp",
       [](const JJ& x) { return exp(x); },
       [](double x) { return exp(x); },
       [](double x) { return exp(x); },
       [](double x) { return exp(x); }},
      {"log",
       [](const JJ& x) { return log(x); },
       [](double x) { return log(x); },
       [](double x) { return 1 / x; },
       [=](double x) { return -1 / square(x); }},
      {"sin",
       [](const JJ& x) { return sin(x); },
       [](double x) { return sin(x); },
       [](double x) { return cos(x); },
       [](double x) { return -sin(x); }},
      {"cos",
       [](const JJ& x) { return cos(x); },
       [](double x) { return cos(x); },
       [](double x) { return -sin(x); },
       [](double x) { return -cos(x); }},
      {"tan",
       [](const JJ& x) { return tan(x); },
       [](double x) { return tan(x); },
       [=](double x) { return 1 / square(cos(x)); },
       [=](double x) { return 2 * tan(x) / square(cos(x)); }},
      {"asin",
       [](const JJ& x) { return asin(x); },
       [](double x) { return asin(x); },
       [=](double x) { return 1 / sqrt(1 - square(x)); },
       [=](double x) { return x / pow(1 - square(x), 1.5); }},
      {"acos",
       [](const JJ& x) { return acos(x); },
       [](double x) { return acos(x); },
       [=](double x) { return -1 / sqrt(1 - square(x)); },
       [=](double x) { return -x / pow(1 - square(x), 1.5); }},
      {"atan",
       [](const JJ& x) { return atan(x); },
       [](double x) { return atan(x); },
       [=](double x) { return 1 / (1 + square(x)); },
       [=](double x) { return -2 * x / square(1 + square(x)); }},
      {"sinh",
       [](const JJ& x) { return sinh(x); },
       [](double x) { return sinh(x); },
       [](double x) { return cosh(x); },
       [](double x) { return sinh(x); }},
      {"cosh",
       [](const JJ& x) { return cosh(x); },
       [](double x) { return cosh(x); },
       [](double x) { return sinh(x); },
       [](double x) { return cosh(x); }},
      {"tanh",
       [](const JJ& x) { return tanh(x); },
       [](double x) { return tanh(x); },
       [=](double x) { return 1 - square(tanh(x)); },
       [=](double x) { return -2 * tanh(x) * (1 - square(tanh(x))); }},
      {"pow of a number",
       [](const JJ& x) { return pow(x, 2.5); },
       [](double x) { return pow(x, 2.5); },
       [](double x) { return 2.5 * pow(x, 1.5); },
       [](double x) { return 3.75 * sqrt(x); }},
      {"pow of itself",
       [](const JJ& x) { return pow(x, x); },
       [](double x) { return pow(x, x); },
       [](double x) { return pow(x, x) * (1 + log(x)); },
       [=](double x) { return pow(x, x) * (square(1 + log(x)) + 1 / x); }},
      {"hypot",
       [](const JJ& x) { return hypot(x, JJ(3.0)); },
       [](double x) { return std::hypot(x, 3.0); },
       [](double x) { return x / std::hypot(x, 3.0); },
       [](double x) { return 9 / pow(std::hypot(x, 3.0), 3); }},
      {"atan2",
       [](const JJ& x) { return atan2(x, JJ(-3.0)); },
       [](double x) { return std::atan2(x, -3.0); },
       [=](double x) { return -3 / (9 + square(x)); },
       [=](double x) { return 6 * x / square(9 + square(x)); }},
  };
}

TEST(Jet, FunctionsWithTheirFirstTwoDerivatives) {
  for (const Function& function : functions()) {
    const double x = function.at;
    const JJ y = function.of(second(x, 1));
    EXPECT_NEAR(y.a.a, function.value(x), kFew) << function.name;
    EXPECT_NEAR(y.a.v[1], function.slope(x), kFew) << function.name;
    EXPECT_NEAR(y.v[1].a, function.slope(x), kFew) << function.name;
    EXPECT_NEAR(y.v[1].v[1], function.curvature(x), 2 * kFew) << function.name;
    EXPECT_EQ(y.v[0].a, 0) << function.name;
  }
}

// A power at zero has the derivatives of the polynomial.
TEST(Jet, PowersAtZero) {
  const J zero = variable(0, 0);
  EXPECT_EQ(pow(zero, 2).v[0], 0);
  EXPECT_EQ(pow(zero, 1).v[0], 1);
  EXPECT_EQ(pow(zero, 0).a, 1);
  EXPECT_EQ(pow(zero, 0).v[0], 0);
}

TEST(Jet, OfPacksAsOfDoubles) {
  using P = Pack<4>;
  const std::array<double, 4> values = {0.1, -0.4, 1.7, 3};
  const Jet<P, 1> x(P::load(values.data()), 0);
  const Jet<P, 1> y = sin(2 * x) / (1 + x * x);
  std::array<double, 4> value;
  std::array<double, 4> slope;
  y.a.store(value.data());
  y.v[0].store(slope.data());
  for (int l = 0; l < 4; ++l) {
    const Jet<double, 1> one(values[l], 0);
    const Jet<double, 1> expected = sin(2 * one) / (1 + one * one);
    EXPECT_NEAR(value[l], expected.a, kFew);
    EXPECT_NEAR(slope[l], expected.v[0], kFew);
  }
}

}  // namespace
}  // namespace carnot::jet_test
