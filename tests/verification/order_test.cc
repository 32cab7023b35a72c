// Gauss methods of s = 1..4 stages have order 2s. Explicit Runge-Kutta 4 has order 4.
#include "testing/order_law.h"
#include "testing/runge_kutta4.h"

namespace carnot::order_test {
namespace {

// In long double: order 8 needs the room below double.
using T = long double;
const std::vector<int> kStepCounts = {24, 32, 42, 56};

class OrderTest : public ::testing::Test {
 protected:
  const test::OrderSystem system_{{}};
  // Order 8 with steps of a fifth of the smallest of the others: at round-off.
  const Vector<T, 8> reference_ = test::end_point<4, T>(system_, 280);
};

TEST_F(OrderTest, OneStage) {
  test::expect_order(test::measure_order<1, T>(system_, reference_, kStepCounts), 2);
}
TEST_F(OrderTest, TwoStages) {
  test::expect_order(test::measure_order<2, T>(system_, reference_, kStepCounts), 4);
}
TEST_F(OrderTest, ThreeStages) {
  test::expect_order(test::measure_order<3, T>(system_, reference_, kStepCounts), 6);
}
TEST_F(OrderTest, FourStages) {
  test::expect_order(test::measure_order<4, T>(system_, reference_, kStepCounts), 8);
}

// The measure itself is right on a method whose order is known from elsewhere.
TEST_F(OrderTest, RungeKutta4) {
  std::vector<double> steps;
  std::vector<double> errors;
  for (const int count : {50, 70, 100, 140}) {
    const double h = static_cast<double>(test::kOrderDuration) / count;
    Vector<double, 8> z = test::vehicle_start(system_).value;
    for (int i = 0; i < count; ++i) z = test::runge_kutta4_step(system_, h, z);
    steps.push_back(h);
    errors.push_back((z - reference_.cast<double>()).cwiseAbs().maxCoeff());
  }
  test::expect_order(test::fit_order(steps, errors, 1e-13, 1e-2), 4);
}

}  // namespace
}  // namespace carnot::order_test
