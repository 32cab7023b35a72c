#include "carnot/plots/page.h"

#include <gtest/gtest.h>

#include <limits>

namespace carnot::plots::page_test {
namespace {

Axis axis_of(double lower, double upper) {
  Interval values;
  values.include(lower);
  values.include(upper);
  return Axis(values);
}

TEST(Axis, IsNeverEmpty) {
  EXPECT_GT(Axis(Interval{}).span(), 0);
  for (const double x : {0.0, 1.0, -4.5e9, 1e100, 1e-200}) {
    const Axis axis = axis_of(x, x);
    EXPECT_EQ(axis.span(), 1) << x;
    EXPECT_LT(axis.lower, axis.at(x)) << x;
    EXPECT_GT(axis.upper, axis.at(x)) << x;
  }
}

TEST(Axis, FarFromTheOriginTakesAnOffset) {
  const Axis axis = axis_of(4.5e9 - 1, 4.5e9 + 1);
  EXPECT_EQ(axis.offset, 4.5e9);
  EXPECT_EQ(axis.lower, -1);
  EXPECT_EQ(axis.label("x", "length"), "x − 4500000000 [length]");
  EXPECT_EQ(axis_of(-4.5e9, -4.5e9).label("x", ""), "x + 4500000000");
  EXPECT_EQ(axis_of(0, 4.5e9).offset, 0);
}

TEST(Axis, IgnoresWhatIsNotFinite) {
  Interval values;
  values.include(std::numeric_limits<double>::quiet_NaN());
  values.include(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(values.empty());
}

}  // namespace
}  // namespace carnot::plots::page_test
