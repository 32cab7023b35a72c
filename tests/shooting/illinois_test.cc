// Zeros by secants against closed forms.
#include "carnot/shooting/linear/illinois.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

namespace carnot::internal::illinois_test {
namespace {

constexpr double kEnough = 1e-14;

TEST(Illinois, FindsZerosFromBothSides) {
  constexpr double kRoundOff = 4 * std::numeric_limits<double>::epsilon();
  int calls = 0;
  const auto cubic = [&](double x) {
    ++calls;
    return std::optional(x * x * x - 2);
  };
  EXPECT_NEAR(illinois(0, -2, 3, 25, kEnough, cubic), std::cbrt(2.0), kRoundOff);
  EXPECT_LE(calls, 20) << "bisection takes 48";
  EXPECT_NEAR(illinois(3, 25, 0, -2, kEnough, cubic), std::cbrt(2.0), kRoundOff);
}

// Plain secants keep one end for ever here.
TEST(Illinois, KeepsTheZeroBetweenThePlaces) {
  int calls = 0;
  const auto steep = [&](double x) {
    ++calls;
    EXPECT_GE(x, 0);
    EXPECT_LE(x, 1);
    return std::optional(std::pow(x, 20) - 0.5);
  };
  const double zero = std::pow(0.5, 1.0 / 20);
  EXPECT_NEAR(illinois(0, -0.5, 1, 0.5, kEnough, steep), zero, 10 * kEnough);
  EXPECT_LE(calls, 50);
}

TEST(Illinois, EndsWhereThereIsNoValue) {
  int calls = 0;
  const auto broken = [&](double x) {
    return ++calls == 1 ? std::optional(x - 0.3) : std::nullopt;
  };
  const double last = illinois(0, -1, 1, 1, kEnough, broken);
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(last, 0.5);
}

TEST(Illinois, EvaluatesNothingWhereThePlacesAreNear) {
  const auto never = [](double) -> std::optional<double> {
    ADD_FAILURE();
    return std::nullopt;
  };
  EXPECT_EQ(illinois(1, -1, 1 + kEnough / 2, 1, kEnough, never), 1 + kEnough / 2);
}

}  // namespace
}  // namespace carnot::internal::illinois_test
