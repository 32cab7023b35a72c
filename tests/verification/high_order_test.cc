// Gauss methods of s = 5..8 stages have order 2s. In quadruple precision: where the leading error
// term rules, h < 0.1, their errors are below the round-off of long double.
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/float128.hpp>

#include "testing/order_law.h"

namespace carnot::high_order_test {
namespace {

using T = boost::multiprecision::float128;
const std::vector<int> kStepCounts = {30, 38, 48, 60};

class HighOrderTest : public ::testing::Test {
 protected:
  const test::OrderSystem system_{{}};
  // The best method with steps of less than half the smallest of the others: at order 16 its error
  // is 1e-6 times theirs.
  const Vector<T, 8> reference_ = test::end_point<8, T>(system_, 150);
};

TEST_F(HighOrderTest, FiveStages) {
  test::expect_order(test::measure_order<5, T>(system_, reference_, kStepCounts), 10);
}
TEST_F(HighOrderTest, SixStages) {
  test::expect_order(test::measure_order<6, T>(system_, reference_, kStepCounts), 12);
}
TEST_F(HighOrderTest, SevenStages) {
  test::expect_order(test::measure_order<7, T>(system_, reference_, kStepCounts), 14);
}
TEST_F(HighOrderTest, EightStages) {
  test::expect_order(test::measure_order<8, T>(system_, reference_, kStepCounts), 16);
}

}  // namespace
}  // namespace carnot::high_order_test
