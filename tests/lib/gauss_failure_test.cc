// One step that cannot be done: the reason is named and the state is what it was.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/step/gauss.h"
#include "testing/counting_system.h"
#include "testing/failing_scenes.h"
#include "testing/runs.h"

namespace carnot::gauss_failure_test {
namespace {

using test::CountingSystem;
using Vehicle = VelocityConstraints<scenes::Vehicle>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class System, int s>
void expect_failure(const System& system,
                    const State<double, System::kDof>& start,
                    double h,
                    StepStatus status,
                    RateStatus rate) {
  Gauss<System, s> step(system);
  auto z = start;
  z.compensation.setConstant(1e-20);
  const auto before = z;
  const StepReport report = step.step(0, h, z);
  EXPECT_EQ(report.status, status);
  EXPECT_EQ(report.rate, rate);
  // Bit for bit, not-a-numbers included.
  for (int i = 0; i < 2 * System::kDof; ++i) {
    EXPECT_TRUE(z.value[i] == before.value[i] || std::isnan(before.value[i]));
    EXPECT_EQ(z.compensation[i], before.compensation[i]);
  }
}

TEST(GaussFailureTest, RankLossAtTheStart) {
  const VelocityConstraints<test::DependentRows> system{{}};
  const auto z = make_state<double, 3>({0, 0, 0}, {1, 2, 3});
  expect_failure<decltype(system), 2>(
      system, z, 0.1, StepStatus::kRateFailed, RateStatus::kConstraintRank);
}

// A particle in -q^4 from q = 1 is at infinity after a time of order 1: no step gets past it.
TEST(GaussFailureTest, NoSolutionOfTheStages) {
  const VelocityConstraints<test::RunAway> system{{}};
  const auto z = make_state<double, 1>(Vector<double, 1>(1), Vector<double, 1>(3));
  Gauss<VelocityConstraints<test::RunAway>, 2> step(system);
  auto after = z;
  const StepReport report = step.step(0, 10, after);
  EXPECT_NE(report.status, StepStatus::kOk);
  EXPECT_EQ(after.value, z.value);
}

TEST(GaussFailureTest, FailedRateAtEveryCall) {
  CountingSystem<Vehicle> system{scenes::Vehicle{}};
  system.fail_from = 1;
  system.fail_to = std::numeric_limits<long>::max();
  expect_failure<CountingSystem<Vehicle>, 2>(system,
                                             make_state<double, 4>({0, 0, 0, 0}, {1, 1, 1, 1}),
                                             0.1,
                                             StepStatus::kRateFailed,
                                             RateStatus::kNotFinite);
}

// A NaN anywhere in z, also in a coordinate that the rate does not read, is no success.
TEST(GaussFailureTest, NotANumberInAnyComponent) {
  const Vehicle system({});
  for (int i = 0; i < 8; ++i) {
    auto z = make_state<double, 4>({0, 0, 0, 0.1}, {1, 1, 1, 1});
    z.value[i] = kNan;
    Gauss<Vehicle, 2> step(system);
    EXPECT_NE(step.step(0, 0.1, z).status, StepStatus::kOk) << "component " << i;
  }
}

// After a failure the same stepper serves again, as if new.
TEST(GaussFailureTest, StepperRecovers) {
  CountingSystem<Vehicle> system{scenes::Vehicle{}};
  const Vehicle sound{scenes::Vehicle{}};
  test::Generator generator(7);
  Gauss<CountingSystem<Vehicle>, 4> step(system);
  auto z = test::random_state<4>(generator);
  ASSERT_EQ(step.step(0, 0.1, z).status, StepStatus::kOk);
  system.fail_from = system.calls + 1;
  system.fail_to = std::numeric_limits<long>::max();
  ASSERT_EQ(step.step(0.1, 0.1, z).status, StepStatus::kRateFailed);
  system.fail_from = system.fail_to = -1;
  auto fresh_z = z;
  Gauss<Vehicle, 4> fresh(sound);
  ASSERT_EQ(step.step(0.1, 0.1, z).status, StepStatus::kOk);
  ASSERT_EQ(fresh.step(0.1, 0.1, fresh_z).status, StepStatus::kOk);
  EXPECT_EQ(z.value, fresh_z.value);
}

}  // namespace
}  // namespace carnot::gauss_failure_test
