#include "carnot/plots/script.h"

#include <gtest/gtest.h>

#include <limits>

namespace carnot::plots::script_test {
namespace {

TEST(Script, NamesBecomeMarkup) {
  EXPECT_EQ(symbol("theta"), "θ");
  EXPECT_EQ(symbol("x1"), "x_{1}");
  EXPECT_EQ(symbol("a_b"), "a\\_b");
  EXPECT_EQ(symbol("7"), "7");
  EXPECT_EQ(with_unit("x", "length^2"), "x [length^{2}]");
  EXPECT_EQ(with_unit("x", ""), "x");
}

TEST(Script, QuotesCannotBeLeft) { EXPECT_EQ(quoted("it's\n{x}"), "'it''s \\{x\\}'"); }

TEST(Script, ValuesThatAreNotFiniteBecomeOneGap) {
  Script script;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(script.data({{nan, 1}, {1, 2}, {nan, 0}, gap(), {3, 1e300}, {4, 5}}), "$d1");
  EXPECT_EQ(script.text(), "$d1 << EOD\n1 2\n\n4 5\nEOD\n");
  EXPECT_EQ(script.data({{nan, nan}}), "");
  EXPECT_EQ(script.data({}), "");
}

TEST(Script, TimeColorsRunFromStartToGoal) {
  EXPECT_EQ(TimeColors::argb(0, 0), 0x0d0887);
  EXPECT_EQ(TimeColors::argb(1, 0), 0xf07f2f);
  EXPECT_EQ(TimeColors::argb(2, 0x80), 0x80f07f2fU);
}

}  // namespace
}  // namespace carnot::plots::script_test
