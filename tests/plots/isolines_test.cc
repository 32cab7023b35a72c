#include "carnot/plots/isolines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace carnot::plots::isolines_test {
namespace {

std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
  return values;
}

template <class Function>
std::vector<double> values_of(const std::vector<double>& x,
                              const std::vector<double>& y,
                              const Function& f) {
  std::vector<double> values;
  for (const double a : x) {
    for (const double b : y) values.push_back(f(a, b));
  }
  return values;
}

double length(const Isoline& line) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < line.x.size(); i += 3) {
    sum += std::hypot(line.x[i + 1] - line.x[i], line.y[i + 1] - line.y[i]);
  }
  return sum;
}

TEST(Isolines, ACircle) {
  const auto x = evenly(-1.5, 1.5, 301);
  const auto y = evenly(-1.4, 1.4, 281);
  const Isoline line =
      isoline(x, y, values_of(x, y, [](double a, double b) { return std::hypot(a, b); }), 1);
  constexpr double kCell = 0.01;
  EXPECT_NEAR(length(line), 2 * 3.14159265, kCell);
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (i % 3 == 2) {
      EXPECT_TRUE(std::isnan(line.x[i]));
    } else {
      EXPECT_NEAR(std::hypot(line.x[i], line.y[i]), 1, kCell * kCell);
    }
  }
}

TEST(Isolines, AreExactForLinearValues) {
  const auto x = evenly(0, 2, 5);
  const auto y = evenly(-1, 1, 4);
  const Isoline line =
      isoline(x, y, values_of(x, y, [](double a, double b) { return a + 3 * b; }), 0.7);
  ASSERT_FALSE(line.x.empty());
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (i % 3 == 2) continue;
    EXPECT_NEAR(line.x[i] + 3 * line.y[i], 0.7, 1e-15);
  }
}

// Across a saddle the two pieces keep apart, whichever pair of corners is high.
TEST(Isolines, SaddlesKeepApart) {
  for (const double sign : {1.0, -1.0}) {
    for (const double level : {-0.2, 0.2}) {
      const Isoline line = isoline({0, 1}, {0, 1}, {sign, -sign, -sign, sign}, level);
      ASSERT_EQ(line.x.size(), 6U);
      // Each piece cuts off one corner, on the side of the fewer.
      for (const std::size_t i : {0U, 3U}) {
        const double a = 0.5 * (line.x[i] + line.x[i + 1]) - 0.5;
        const double b = 0.5 * (line.y[i] + line.y[i + 1]) - 0.5;
        EXPECT_GT(sign * a * b * level, 0);
      }
    }
  }
}

TEST(Isolines, LeaveOutWhatIsNotKnown) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(isoline({0, 1}, {0, 1}, {0, 1, none, 1}, 0.5).x.empty());
  EXPECT_TRUE(isoline({0}, {0, 1}, {0, 1}, 0.5).x.empty());
  EXPECT_TRUE(isoline({0, 1}, {0, 1}, {0, 0, 0, 0}, 0.5).x.empty());
  EXPECT_THROW((void)isoline({0, 1}, {0, 1}, {0, 1}, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace carnot::plots::isolines_test
