// Each family of methods has its order, on the vehicle in the potential -cos r: nonlinear, with no
// closed form that a method could be lucky on.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/scenes/vehicle_cosine.h"
#include "testing/method_runs.h"
#include "testing/order.h"

namespace carnot::runge_kutta_order_test {
namespace {

// Order 8 needs the room below double.
using T = long double;
using System = VelocityConstraints<scenes::VehicleCosine>;
constexpr int kDuration = 3;

const System& cosine() {
  static const System kSystem{{}};
  return kSystem;
}

Vector<T, 8> end_point(const Tableau<T>& tableau, int steps) {
  RungeKutta<System, kAnyStages, T> method(cosine(), tableau);
  auto z = test::cast_state<T, 4>(test::vehicle_start(cosine()));
  const T h = T(kDuration) / T(steps);
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(method.step(T(i) * h, h, z).status, StepStatus::kOk);
  }
  return z.value;
}

// At round-off: gauss16 with steps of a few hundredths.
const Vector<T, 8>& reference() {
  static const Vector<T, 8> kEnd = end_point(test::tableau_of<T>("gauss16"), 100);
  return kEnd;
}

struct Case {
  const char* name;
  std::vector<int> steps;  // where the leading term of the error rules
};

class OrderOfMethodTest : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Representatives,
                         OrderOfMethodTest,
                         ::testing::Values(Case{"gauss6", {24, 32, 42, 56}},
                                           Case{"midpoint4", {40, 56, 80, 112}},
                                           Case{"midpoint6", {56, 80, 112, 160}},
                                           Case{"midpoint8", {20, 28, 40, 56}},
                                           Case{"lobatto2", {100, 140, 200, 280}},
                                           Case{"lobatto4", {40, 56, 80, 112}},
                                           Case{"radau5", {40, 56, 80, 112}},
                                           Case{"dop853", {28, 40, 56, 80}}),
                         [](const auto& method) { return std::string(method.param.name); });

TEST_P(OrderOfMethodTest, SlopeOfTheError) {
  constexpr double kSlopeTolerance = 0.15;
  constexpr double kPlateau = 500 * std::numeric_limits<T>::epsilon();  // a hundred steps
  constexpr double kCeiling = 1e-2;
  const Tableau<T> tableau = test::tableau_of<T>(GetParam().name);
  std::vector<double> steps;
  std::vector<double> errors;
  for (const int count : GetParam().steps) {
    steps.push_back(static_cast<double>(kDuration) / count);
    const Vector<T, 8> error = end_point(tableau, count) - reference();
    errors.push_back(static_cast<double>(error.cwiseAbs().maxCoeff()));
  }
  const LineFit fit = test::fit_order(steps, errors, kPlateau, kCeiling);
  EXPECT_GE(fit.points, 3);
  EXPECT_GT(fit.correlation, 0.99);
  EXPECT_NEAR(fit.slope, tableau.order, kSlopeTolerance);
}

}  // namespace
}  // namespace carnot::runge_kutta_order_test
