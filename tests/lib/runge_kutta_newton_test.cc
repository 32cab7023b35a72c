// Where the fixed point does not contract: Newton's method for the stages of every kind of
// coupling, and honest failure.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/counting_system.h"
#include "testing/method_runs.h"
#include "testing/oscillator.h"

namespace carnot::runge_kutta_newton_test {
namespace {

using test::CountingSystem;
using test::Generator;
using test::Oscillator;
using Cosine = VelocityConstraints<scenes::VehicleCosine>;
using Counting = CountingSystem<Cosine>;

constexpr double kEps = std::numeric_limits<double>::epsilon();

using RungeKuttaNewtonTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Implicit,
                         RungeKuttaNewtonTest,
                         ::testing::Values("gauss6", "midpoint4", "lobatto4", "radau5"),
                         test::method_test_name);

// The rate at the start, then the fixed point: a failure there sends the step to Newton.
TEST_P(RungeKuttaNewtonTest, AgreesWithTheFixedPoint) {
  Generator generator(1);
  for (int sample = 0; sample < 20; ++sample) {
    const Cosine system(test::uneven<scenes::VehicleCosine>());
    Counting failing(test::uneven<scenes::VehicleCosine>());
    failing.fail_from = failing.fail_to = 7;
    RungeKutta<Cosine> plain(system, tableau_);
    RungeKutta<Counting> fallen(failing, tableau_);
    auto a = test::random_state<4>(generator);
    auto b = a;
    const auto before = a;
    const StepReport by_fixed_point = plain.step(0, 0.1, a);
    const StepReport by_newton = fallen.step(0, 0.1, b);
    ASSERT_EQ(by_fixed_point.status, StepStatus::kOk);
    ASSERT_EQ(by_newton.status, StepStatus::kOk);
    EXPECT_FALSE(by_fixed_point.newton);
    EXPECT_TRUE(by_newton.newton);
    EXPECT_EQ(by_newton.rate, RateStatus::kOk);
    EXPECT_EQ(by_newton.evaluations, failing.calls);
    EXPECT_LE(test::relative_distance(b.value, a.value), 64 * kEps);
    EXPECT_LE(test::stage_defect(fallen, 0.1, before), 64 * kEps);
  }
}

// Large steps. A step may stop at changes of 1000 eps, and the equations amplify them by
// |I - h A|, up to 1e3 here.
TEST_P(RungeKuttaNewtonTest, SolvesTheStagesWhereTheFixedPointDoesNotContract) {
  constexpr double kTolerance = 1e6 * kEps;
  constexpr double kStep = 2;
  Generator generator(2);
  int newton_steps = 0;
  const Cosine system(scenes::VehicleCosine{});
  for (int sample = 0; sample < 100; ++sample) {
    RungeKutta<Cosine> step(system, tableau_);
    const auto before = test::random_state<4>(generator);
    auto z = before;
    const StepReport report = step.step(0, kStep, z);
    if (report.status != StepStatus::kOk) {
      EXPECT_EQ(z.value, before.value);
      continue;
    }
    EXPECT_LE(test::stage_defect(step, kStep, before), kTolerance);
    newton_steps += report.newton ? 1 : 0;
  }
  EXPECT_GE(newton_steps, 10);
}

// Here q' depends on p alone and p' on q alone, so the errors of q and p take turns, and with
// IIIA-IIIB one of them vanishes: that is not the end of the contraction.
TEST_P(RungeKuttaNewtonTest, IsNotNeededWhereTheFixedPointContracts) {
  const Oscillator system{1};
  RungeKutta<Oscillator> step(system, tableau_);
  auto z = make_state<double, 1>(Vector<double, 1>(0.3), Vector<double, 1>(-0.8));
  for (int i = 0; i < 100; ++i) {
    const auto before = z;
    const StepReport report = step.step(i, 0.5, z);
    ASSERT_EQ(report.status, StepStatus::kOk);
    EXPECT_FALSE(report.newton);
    EXPECT_LE(test::stage_defect(step, 0.5, before), 16 * kEps);
  }
}

// Where the fixed point settles slowly, Newton's method takes over: no step takes as many
// iterations as a contraction of 0.7 needs to round-off, which is 103.
TEST_P(RungeKuttaNewtonTest, TakesOverWhereTheFixedPointContractsSlowly) {
  constexpr int kMostIterations = 110;
  bool last = false;
  for (double frequency = 0.25; frequency < 20; frequency *= 1.1) {
    const Oscillator system{frequency * frequency};
    RungeKutta<Oscillator> step(system, tableau_);
    auto z = make_state<double, 1>(Vector<double, 1>(0.3), Vector<double, 1>(-0.8));
    const auto before = z;
    const StepReport report = step.step(0, 1, z);
    ASSERT_EQ(report.status, StepStatus::kOk) << frequency;
    EXPECT_LE(report.evaluations, kMostIterations * tableau_.stages()) << frequency;
    EXPECT_LE(test::stage_defect(step, 1.0, before), frequency * frequency * 64 * kEps);
    EXPECT_TRUE(report.newton || !last) << frequency;  // once slow, slow for all that are faster
    last = report.newton;
  }
  EXPECT_TRUE(last);
}

// A stiff oscillator, where the step is a rational function of (h w)^2 = 1e4 and Newton is exact.
TEST_P(RungeKuttaNewtonTest, StiffOscillator) {
  const Oscillator system{1e4};
  const Vector<double, 2> start(0.3, -0.8);
  RungeKutta<Oscillator> step(system, tableau_);
  State<double, 1> z{start, Vector<double, 2>::Zero()};
  for (int i = 0; i < 20; ++i) {
    const auto before = z;
    const StepReport report = step.step(i, 1, z);
    ASSERT_EQ(report.status, StepStatus::kOk);
    EXPECT_TRUE(report.newton);
    // The stages q, p differ by w = 100; the increments are w^2 times as sensitive.
    EXPECT_LE(test::stage_defect(step, 1.0, before), 1e4 * 64 * kEps);
  }
  if (is_symplectic(tableau_) && !tableau_.partitioned) {
    // Gauss methods and compositions of the midpoint rule keep quadratic invariants.
    const auto energy = [](const Vector<double, 2>& at) {
      return at[1] * at[1] + 1e4 * at[0] * at[0];
    };
    EXPECT_NEAR(energy(z.value) / energy(start), 1, 1e5 * kEps);
  }
}

}  // namespace
}  // namespace carnot::runge_kutta_newton_test
