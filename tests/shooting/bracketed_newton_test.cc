// Zeros by Newton's method against closed forms.
#include "carnot/shooting/linear/bracketed_newton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace carnot::internal::bracketed_newton_test {
namespace {

constexpr double kNear = 1e-14;
// The last place is nearer than kNear, and is rounded.
constexpr double kRoundOff = 2 * kNear + 4 * std::numeric_limits<double>::epsilon();

TEST(BracketedNewton, FindsZerosFromBothSides) {
  int calls = 0;
  const auto at = [](double x) { return ValueAndSlope{x * x * x - 2, 3 * x * x}; };
  const auto cubic = [&](double x) {
    ++calls;
    return std::optional(at(x));
  };
  EXPECT_NEAR(bracketed_newton(0.5, at(0.5), 3, at(3), kNear, cubic), std::cbrt(2.0), kRoundOff);
  EXPECT_LE(calls, 12) << "bisection takes 48";
  EXPECT_NEAR(bracketed_newton(3, at(3), 0.5, at(0.5), kNear, cubic), std::cbrt(2.0), kRoundOff);
}

// log |e(k + 1)| over log |e(k)| tends to 1 + sqrt 3. Newton's method has the order 2.
TEST(BracketedNewton, HasTheOrderOfInverseCubics) {
  std::vector<double> errors;
  const auto at = [](double x) { return ValueAndSlope{std::exp(x) - 2, std::exp(x)}; };
  const auto f = [&](double x) {
    errors.push_back(std::abs(x - std::log(2.0)));
    return std::optional(at(x));
  };
  (void)bracketed_newton(0, at(0), 4, at(4), kNear, f);
  const auto small = std::find_if(errors.begin(), errors.end(), [](double e) { return e < 1e-2; });
  ASSERT_LT(small + 1, errors.end());
  EXPECT_GT(std::log(*(small + 1)) / std::log(*small), 2.4);
}

// Of a cubic x(y) nothing is left after one place.
TEST(BracketedNewton, IsExactForInverseCubics) {
  int calls = 0;
  const auto at = [](double x) {
    return ValueAndSlope{std::cbrt(x) - 1, std::pow(x, -2. / 3) / 3};
  };
  const auto f = [&](double x) {
    ++calls;
    return std::optional(at(x));
  };
  EXPECT_NEAR(bracketed_newton(0.1, at(0.1), 5, at(5), kNear, f), 1, kRoundOff);
  EXPECT_EQ(calls, 1);
}

// Newton's method alone leaves this for ever: its steps grow.
TEST(BracketedNewton, KeepsTheZeroBetweenThePlaces) {
  const auto at = [](double x) { return ValueAndSlope{std::atan(x), 1 / (1 + x * x)}; };
  const auto flat = [&](double x) {
    EXPECT_GE(x, -20);
    EXPECT_LE(x, 30);
    return std::optional(at(x));
  };
  EXPECT_NEAR(bracketed_newton(-20, at(-20), 30, at(30), kNear, flat), 0, kRoundOff);
}

// Halves take over.
TEST(BracketedNewton, FindsTheZeroWithASlopeThatIsWrong) {
  int calls = 0;
  const auto at = [](double x) { return ValueAndSlope{x - 0.3, -1}; };
  const auto wrong = [&](double x) {
    ++calls;
    return std::optional(at(x));
  };
  EXPECT_NEAR(bracketed_newton(0, at(0), 1, {0.5, -1}, kNear, wrong), 0.3, kRoundOff);
  EXPECT_LE(calls, 100);
}

TEST(BracketedNewton, EndsWhereThereIsNoValue) {
  int calls = 0;
  const auto broken = [&](double x) {
    return ++calls == 1 ? std::optional<ValueAndSlope>({x - 0.3, 1}) : std::nullopt;
  };
  EXPECT_EQ(bracketed_newton(0, {-1, 2}, 1, {1, 2}, kNear, broken), 0.5);
  EXPECT_EQ(calls, 2);
  calls = 1;
  EXPECT_EQ(bracketed_newton(0, {-1, 2}, 1, {1, 2}, kNear, broken), 1) << "of none the place is b";
}

}  // namespace
}  // namespace carnot::internal::bracketed_newton_test
