// What counts as the same output, and what does not.
#include "docs/printed.h"

#include <gtest/gtest.h>

namespace carnot::docs {
namespace {

TEST(PrintedTest, AcceptsRoundOff) {
  EXPECT_TRUE(agrees("action   22.7078818\n\n", "action 22.7078817\n"));
  EXPECT_TRUE(agrees("drift 4.48e-05", "drift 4.47e-05"));
  EXPECT_TRUE(agrees("error 1.7e-13", "error 0"));
  EXPECT_TRUE(agrees("p (1, -0.2499999999999)", "p (0.99999999999998, -0.25)"));
  EXPECT_TRUE(agrees("19 of 24 starts converged, gauss16, 0.2 s",
                     "18 of 24 starts converged, gauss16, 11 s"));
}

TEST(PrintedTest, NoticesADifference) {
  EXPECT_FALSE(agrees("action 22.7078818", "action 22.7078828"));
  EXPECT_FALSE(agrees("action 22.7078818", "action -22.7078818"));
  EXPECT_FALSE(agrees("drift 4.48e-05", "drift 4.48e-06"));
  EXPECT_FALSE(agrees("error 1.7e-13", "error 1.7e-09"));
  EXPECT_FALSE(agrees("step 0.1", "step 0.2"));
  EXPECT_FALSE(agrees("100 steps", "101 steps"));
  EXPECT_FALSE(agrees("gauss16", "gauss12"));
  EXPECT_FALSE(agrees("p (1, 2)", "p (1, 2, 3)"));
  EXPECT_FALSE(agrees("one\ntwo", "one"));
  EXPECT_FALSE(agrees("19 of 24 starts converged, gauss16, 0.2 s",
                      "19 of 24 starts converged, gauss4, 0.2 s"));
}

}  // namespace
}  // namespace carnot::docs
