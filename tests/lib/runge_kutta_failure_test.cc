// A step that cannot be done, by any kind of method: the reason is named, the state is what it was,
// and the stepper serves again as if new. (With branches: runge_kutta_branch_test.cc.)
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/failing_scenes.h"
#include "testing/method_runs.h"
#include "testing/oscillator.h"

namespace carnot::runge_kutta_failure_test {
namespace {

using test::expect_refused;
using test::Oscillator;
using RunAway = VelocityConstraints<test::RunAway>;

using RungeKuttaFailureTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Representatives,
                         RungeKuttaFailureTest,
                         ::testing::ValuesIn(test::kRepresentatives),
                         test::method_test_name);

// In -q^4 a large step ends in infinities. None of them is left for the next step.
TEST_P(RungeKuttaFailureTest, ForgetsInfinities) {
  const RunAway system{{}};
  RungeKutta<RunAway> step(system, tableau_);
  auto z = make_state<double, 1>(Vector<double, 1>(3), Vector<double, 1>(30));
  expect_refused(step, 0, 1e60, z);
  RungeKutta<RunAway> fresh(system, tableau_);
  auto fresh_z = z;
  const StepReport report = step.step(0, 1e-3, z);
  const StepReport fresh_report = fresh.step(0, 1e-3, fresh_z);
  ASSERT_EQ(report.status, StepStatus::kOk);
  ASSERT_EQ(fresh_report.status, StepStatus::kOk);
  EXPECT_FALSE(report.newton);
  EXPECT_EQ(report.evaluations, fresh_report.evaluations);
  EXPECT_EQ(z.value, fresh_z.value);
}

// A system that sees nothing wrong with infinite coordinates: q' = p, p' = 0.
TEST_P(RungeKuttaFailureTest, NeverReturnsAnInfiniteState) {
  const Oscillator system{0};
  RungeKutta<Oscillator> step(system, tableau_);
  auto z = make_state<double, 1>(Vector<double, 1>(0), Vector<double, 1>(1e300));
  expect_refused(step, 0, 1e20, z);
  ASSERT_EQ(step.step(0, 1, z).status, StepStatus::kOk);
  // The weights of dop853 are up to 6 and sum to one.
  EXPECT_NEAR(z.value[0] / 1e300, 1, 32 * std::numeric_limits<double>::epsilon());
}

// A NaN anywhere in z, also in a coordinate that the rate does not read, is no success.
TEST_P(RungeKuttaFailureTest, NotANumberInAnyComponent) {
  const Oscillator system{0};
  for (int i = 0; i < 2; ++i) {
    auto z = make_state<double, 1>(Vector<double, 1>(0.1), Vector<double, 1>(0.2));
    z.value[i] = std::numeric_limits<double>::quiet_NaN();
    RungeKutta<Oscillator> step(system, tableau_);
    const StepReport report = step.step(0, 0.1, z);
    EXPECT_EQ(report.status, StepStatus::kRateFailed);
    EXPECT_EQ(report.rate, RateStatus::kNotFinite);
  }
}

}  // namespace
}  // namespace carnot::runge_kutta_failure_test
