#include "carnot/plots/units.h"

#include <gtest/gtest.h>

namespace carnot::plots::units_test {
namespace {

TEST(Units, ExponentsAreSuperscripts) {
  EXPECT_EQ(unit_markup("length^2"), "length^{2}");
  EXPECT_EQ(unit_markup("length/time^12"), "length/time^{12}");
  EXPECT_EQ(unit_markup("time^-1"), "time^{−1}");
  EXPECT_EQ(unit_markup("1"), "1");
  EXPECT_EQ(unit_markup(""), "");
}

TEST(Units, OtherTextIsLeftAsItIs) {
  EXPECT_EQ(unit_markup("a_b"), "a\\_b");
  EXPECT_EQ(unit_markup("a^b^"), "a\\^b\\^");
  EXPECT_EQ(unit_markup("a^-"), "a\\^-");
}

TEST(Units, MomentumIsActionOverTheUnitOfTheCoordinate) {
  EXPECT_EQ(momentum_unit("length"), "action/length");
  EXPECT_EQ(momentum_unit("length^2"), "action/length^2");
  EXPECT_EQ(momentum_unit("rad/time"), "action time/rad");
  EXPECT_EQ(momentum_unit("length/time^2"), "action time^2/length");
  EXPECT_EQ(momentum_unit("length*rad"), "action/(length rad)");
  EXPECT_EQ(momentum_unit("length rad/(mass time)"), "action mass time/(length rad)");
  EXPECT_EQ(momentum_unit("1/time"), "action time");
  EXPECT_EQ(momentum_unit("1"), "action");
  EXPECT_EQ(momentum_unit(""), "");
}

}  // namespace
}  // namespace carnot::plots::units_test
