// One p, two solutions of H_y = 0: the steps of every kind of method stay on the branch that they
// began on, and come back to it after a failure.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/scenes/appell.h"
#include "carnot/system/lagrangian_system.h"
#include "testing/counting_system.h"
#include "testing/method_runs.h"

namespace carnot::runge_kutta_branch_test {
namespace {

using Appell = LagrangianSystem<scenes::Appell>;
using Counting = test::CountingSystem<Appell>;
using Algebraic = Vector<double, 4>;
using Step = RungeKutta<Counting>;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long kForever = std::numeric_limits<long>::max();

// One of every kind of coupling.
using RungeKuttaBranchTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Representatives,
                         RungeKuttaBranchTest,
                         ::testing::Values("gauss6", "midpoint4", "lobatto4", "dop853"),
                         test::method_test_name);

const Vector<double, 3>& start_q() {
  static const Vector<double, 3> kQ(0.1, -0.2, 0.3);
  return kQ;
}
const Vector<double, 3>& start_p() {
  static const Vector<double, 3> kP(1.2, 0.5, 0.7);
  return kP;
}

// The solution at the start with the sign of z' as given.
Algebraic branch_of(const Counting& system, int sign) {
  Algebraic y;
  const Vector<double, 1> lambda(system.scene().multiplier(start_p(), sign));
  EXPECT_EQ(system.branch(0, start_q(), start_p(), lambda, y), RateStatus::kOk);
  EXPECT_NEAR(y[3], lambda[0], 64 * kEps);
  return y;
}

// v is linear in time, so methods of order 2 and more are exact.
TEST_P(RungeKuttaBranchTest, KeepsTheBranchItBeganOn) {
  constexpr int kSteps = 20;
  constexpr double kTolerance = 64 * kSteps * kEps;
  const Counting system(scenes::Appell{1, 0.2, 0});
  for (const int sign : {1, -1}) {
    for (const double h : {0.05, -0.05}) {
      Step step(system, tableau_);
      step.start_on(branch_of(system, sign));
      auto z = make_state<double, 3>(start_q(), start_p());
      for (int i = 0; i < kSteps; ++i) {
        ASSERT_EQ(step.step(i * h, h, z).status, StepStatus::kOk);
        for (int k = 0; k < tableau_.stages(); ++k) {
          EXPECT_GT(sign * step.algebraic(k)[2], 0) << "z' of stage " << k;
        }
      }
      const auto exact = system.scene().closed_form(start_q(), start_p(), sign, kSteps * h);
      EXPECT_LE(test::relative_distance(z.value, exact), kTolerance);
      const int last = tableau_.stages() - 1;
      const Vector<double, 3> p = step.stages().col(last).tail<3>();
      EXPECT_NEAR(step.branch()[3], system.scene().multiplier(p, sign), kTolerance);
    }
  }
}

// Zero leaves the choice to the system, and is no branch of its own.
TEST_P(RungeKuttaBranchTest, ColdStartIsOneOfThem) {
  const Counting system(scenes::Appell{1, 0.2, 0});
  Step cold(system, tableau_);
  auto z = make_state<double, 3>(start_q(), start_p());
  ASSERT_EQ(cold.step(0, 0.1, z).status, StepStatus::kOk);
  const int sign = cold.branch()[2] > 0 ? 1 : -1;
  const auto exact = system.scene().closed_form(start_q(), start_p(), sign, 0.1);
  EXPECT_LE(test::relative_distance(z.value, exact), 64 * kEps);

  // Another start takes the stepper to the other branch.
  cold.start_on(branch_of(system, -sign));
  z = make_state<double, 3>(start_q(), start_p());
  ASSERT_EQ(cold.step(0, 0.1, z).status, StepStatus::kOk);
  const auto other = system.scene().closed_form(start_q(), start_p(), -sign, 0.1);
  EXPECT_LE(test::relative_distance(z.value, other), 64 * kEps);
}

// The rate fails at the k-th call of the second step and from then on.
TEST_P(RungeKuttaBranchTest, FailureLeavesStateAndBranchAsTheyWere) {
  Counting system(scenes::Appell{1, 0.3, 0.5});
  const Algebraic lower = branch_of(system, -1);
  for (const int k : {1, 2, 5, 12}) {
    system.fail_from = system.fail_to = -1;
    Step step(system, tableau_);
    step.start_on(lower);
    auto z = make_state<double, 3>(start_q(), start_p());
    ASSERT_EQ(step.step(0, 0.05, z).status, StepStatus::kOk);
    system.fail_from = system.calls + k;
    system.fail_to = kForever;
    test::expect_refused(step, 0.05, 0.05, z);

    system.fail_from = system.fail_to = -1;
    Step fresh(system, tableau_);
    fresh.start_on(step.branch());
    auto fresh_z = z;
    ASSERT_EQ(step.step(0.05, 0.04, z).status, StepStatus::kOk);
    ASSERT_EQ(fresh.step(0.05, 0.04, fresh_z).status, StepStatus::kOk);
    EXPECT_EQ(z.value, fresh_z.value);
    EXPECT_EQ(step.branch(), fresh.branch());
  }
}

}  // namespace
}  // namespace carnot::runge_kutta_branch_test
