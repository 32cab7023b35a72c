// One step: what it leaves behind, and Newton's fallback.
#include "carnot/step/gauss.h"

#include <gtest/gtest.h>

#include <limits>

#include "testing/counting_system.h"
#include "testing/runs.h"

namespace carnot::gauss_test {
namespace {

using test::CountingSystem;
using test::Generator;
using Vehicle = VelocityConstraints<scenes::Vehicle>;
using Cosine = VelocityConstraints<scenes::VehicleCosine>;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// A step may stop at changes of 1000 eps; the equations amplify them by |I - h A|, up to 1e3 here.
constexpr double kStageTolerance = 1e6 * kEps;

// How far the stages are from U_i = z + sum_j mu_ij L_j and L_i = h b_i f(U_i), over their size.
template <class Step>
double stage_defect(const Step& step, double h, const State<double, Step::kDof>& before) {
  constexpr int kSize = Step::kSize;
  double defect = 0;
  for (int i = 0; i < Step::kStages; ++i) {
    Vector<double, kSize> u = before.value + before.compensation;
    for (int j = 0; j < Step::kStages; ++j) {
      u += step.tableau().mu(i, j) * step.increments().col(j);
    }
    Vector<double, Step::System::kAlgebraic> y = step.algebraic(i);
    Vector<double, kSize> f;
    const Vector<double, kSize> stage = step.stages().col(i);
    EXPECT_EQ(phase_rate(step.system(), step.stage_time(i), stage, y, f), RateStatus::kOk);
    const Vector<double, kSize> increment = h * step.tableau().b[i] * f;
    defect = std::max(defect, test::relative_distance(u, stage));
    defect = std::max(
        defect,
        test::relative_distance(increment, Vector<double, kSize>(step.increments().col(i))));
  }
  return defect;
}

TEST(GaussTest, StagesSolveTheirEquations) {
  const Cosine system(test::uneven<scenes::VehicleCosine>());
  Generator generator(1);
  for (int sample = 0; sample < 50; ++sample) {
    Gauss<Cosine, 4> step(system);
    auto z = test::random_state<4>(generator);
    for (int i = 0; i < 3; ++i) {  // from the rate, then from the extrapolated polynomial
      const auto before = z;
      ASSERT_EQ(step.step(0.1 * i, 0.1, z).status, StepStatus::kOk);
      EXPECT_LE(stage_defect(step, 0.1, before), 64 * kEps);
      const Vector<double, 8> sum = before.value + step.increments().rowwise().sum();
      EXPECT_LE(test::relative_distance(z.value, sum), 4 * kEps);
    }
  }
}

// The first guess decides the cost only.
TEST(GaussTest, WarmStartDoesNotChangeTheStep) {
  const Vehicle system(test::uneven<scenes::Vehicle>());
  Generator generator(2);
  Gauss<Vehicle, 8> warm(system);
  auto z = test::random_state<4>(generator);
  for (int i = 0; i < 20; ++i) {
    auto cold_z = z;
    Gauss<Vehicle, 8> cold(system);
    const StepReport cold_report = cold.step(0.1 * i, 0.1, cold_z);
    const StepReport warm_report = warm.step(0.1 * i, 0.1, z);
    ASSERT_EQ(warm_report.status, StepStatus::kOk);
    ASSERT_EQ(cold_report.status, StepStatus::kOk);
    EXPECT_LE(test::relative_distance(z.value, cold_z.value), 8 * kEps);
  }
}

TEST(GaussTest, StepOfLengthZeroIsTheIdentity) {
  const Vehicle system({});
  Generator generator(3);
  const auto start = test::random_state<4>(generator);
  auto z = start;
  Gauss<Vehicle, 3> step(system);
  ASSERT_EQ(step.step(0, 0, z).status, StepStatus::kOk);
  EXPECT_EQ(z.value, start.value);
}

// A rate that fails once, in the fixed point, sends the same step to Newton: same answer.
TEST(GaussTest, NewtonAgreesWithFixedPoint) {
  const Vehicle system(test::uneven<scenes::Vehicle>());
  Generator generator(4);
  for (int sample = 0; sample < 20; ++sample) {
    CountingSystem<Vehicle> failing(test::uneven<scenes::Vehicle>());
    failing.fail_from = failing.fail_to = 7;
    Gauss<Vehicle, 4> plain(system);
    Gauss<CountingSystem<Vehicle>, 4> fallen(failing);
    auto a = test::random_state<4>(generator);
    auto b = a;
    const StepReport by_fixed_point = plain.step(0, 0.1, a);
    const StepReport by_newton = fallen.step(0, 0.1, b);
    ASSERT_EQ(by_fixed_point.status, StepStatus::kOk);
    ASSERT_EQ(by_newton.status, StepStatus::kOk);
    EXPECT_FALSE(by_fixed_point.newton);
    EXPECT_TRUE(by_newton.newton);
    EXPECT_EQ(by_newton.rate, RateStatus::kOk);
    EXPECT_LE(test::relative_distance(b.value, a.value), 64 * kEps);
  }
}

// Large steps: the fixed point does not contract, Newton does.
TEST(GaussTest, NewtonTakesOverWhereFixedPointDoesNotContract) {
  constexpr double kStep = 2;
  Generator generator(5);
  int newton_steps = 0;
  for (int sample = 0; sample < 100; ++sample) {
    const Cosine system(scenes::VehicleCosine{});
    Gauss<Cosine, 2> step(system);
    const auto before = test::random_state<4>(generator);
    auto z = before;
    const StepReport report = step.step(0, kStep, z);
    if (report.status != StepStatus::kOk || !report.newton) continue;
    ++newton_steps;
    EXPECT_LE(stage_defect(step, kStep, before), kStageTolerance);
  }
  EXPECT_GE(newton_steps, 10);
}

// However large the step: either the stage equations hold or the step says that it failed, and
// then the state is what it was.
template <int s>
void expect_honest_steps() {
  const Cosine system(scenes::VehicleCosine{});
  Generator generator(6);
  int failures = 0;
  for (const double h : {0.5, 1.0, 2.0, 4.0, 8.0, 100.0}) {
    for (int sample = 0; sample < 100; ++sample) {
      Gauss<Cosine, s> step(system);
      const auto before = test::random_state<4>(generator);
      auto z = before;
      const StepReport report = step.step(0, h, z);
      if (report.status == StepStatus::kOk) {
        EXPECT_LE(stage_defect(step, h, before), kStageTolerance) << "h = " << h;
        EXPECT_TRUE(z.value.allFinite());
      } else {
        EXPECT_EQ(z.value, before.value);
        EXPECT_EQ(z.compensation, before.compensation);
        const bool diverged = report.status == StepStatus::kStagesDiverged;
        EXPECT_NE(diverged, report.rate != RateStatus::kOk) << "one reason, named";
        failures += diverged ? 1 : 0;
      }
    }
  }
  EXPECT_GT(failures, 0) << "100 is no step for this scene";
}
TEST(GaussTest, NoStepIsSilentlyWrongOneStage) { expect_honest_steps<1>(); }
TEST(GaussTest, NoStepIsSilentlyWrongFourStages) { expect_honest_steps<4>(); }

}  // namespace
}  // namespace carnot::gauss_test
