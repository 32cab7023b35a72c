// Zeros by Newton's method against closed forms.
#include "carnot/shooting/linear/bracketed_newton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

namespace carnot::internal::bracketed_newton_test {
namespace {

constexpr double kNear = 1e-8;
// The square of a step of that size is less.
constexpr double kRoundOff = 4 * std::numeric_limits<double>::epsilon();

TEST(BracketedNewton, FindsZerosFromBothSides) {
  int calls = 0;
  const auto cubic = [&](double x) {
    ++calls;
    return std::optional<ValueAndSlope>({x * x * x - 2, 3 * x * x});
  };
  EXPECT_NEAR(bracketed_newton(0, -2, 3, 25, kNear, cubic), std::cbrt(2.0), kRoundOff);
  EXPECT_LE(calls, 12) << "bisection takes 48";
  EXPECT_NEAR(bracketed_newton(3, 25, 0, -2, kNear, cubic), std::cbrt(2.0), kRoundOff);
}

// Newton's method alone leaves this for ever: its steps grow.
TEST(BracketedNewton, KeepsTheZeroBetweenThePlaces) {
  const auto flat = [](double x) {
    EXPECT_GE(x, -20);
    EXPECT_LE(x, 30);
    return std::optional<ValueAndSlope>({std::atan(x), 1 / (1 + x * x)});
  };
  EXPECT_NEAR(bracketed_newton(-20, std::atan(-20), 30, std::atan(30), kNear, flat), 0, kRoundOff);
}

// Halves take over.
TEST(BracketedNewton, FindsTheZeroWithASlopeThatIsWrong) {
  int calls = 0;
  const auto wrong = [&](double x) {
    ++calls;
    return std::optional<ValueAndSlope>({x - 0.3, -1});
  };
  EXPECT_NEAR(bracketed_newton(0, -0.3, 1, 0.5, kNear, wrong), 0.3, kRoundOff);
  EXPECT_LE(calls, 100);
}

TEST(BracketedNewton, EndsWhereThereIsNoValue) {
  int calls = 0;
  const auto broken = [&](double x) {
    return ++calls == 1 ? std::optional<ValueAndSlope>({x - 0.3, 1}) : std::nullopt;
  };
  EXPECT_EQ(bracketed_newton(0, -1, 1, 1, kNear, broken), 0.5);
  EXPECT_EQ(calls, 2);
  calls = 1;
  EXPECT_EQ(bracketed_newton(0, -1, 1, 1, kNear, broken), 1) << "of none the place is b";
}

}  // namespace
}  // namespace carnot::internal::bracketed_newton_test
