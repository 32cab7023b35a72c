// One step of each family of methods: what it solves, what it costs, and one route to it against
// another.
#include "carnot/step/runge_kutta.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/step/gauss.h"
#include "testing/counting_system.h"
#include "testing/method_runs.h"
#include "testing/oscillator.h"

namespace carnot::runge_kutta_test {
namespace {

using test::Generator;
using test::Oscillator;
using test::relative_distance;
using Cosine = VelocityConstraints<scenes::VehicleCosine>;
using Any = RungeKutta<Cosine>;

constexpr double kEps = std::numeric_limits<double>::epsilon();

const Cosine& cosine() {
  static const Cosine kSystem(test::uneven<scenes::VehicleCosine>());
  return kSystem;
}

using RungeKuttaTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Representatives,
                         RungeKuttaTest,
                         ::testing::ValuesIn(test::kRepresentatives),
                         test::method_test_name);

TEST_P(RungeKuttaTest, StagesSolveTheirEquations) {
  constexpr double kTolerance = 256 * kEps;  // dop853 has coefficients up to 40
  Generator generator(1);
  for (int sample = 0; sample < 20; ++sample) {
    Any step(cosine(), tableau_);
    auto z = test::random_state<4>(generator);
    for (int i = 0; i < 3; ++i) {  // from the rate, then from what the last step left
      const auto before = z;
      const StepReport report = step.step(0.1 * i, 0.1, z);
      ASSERT_EQ(report.status, StepStatus::kOk);
      EXPECT_FALSE(report.newton);
      EXPECT_LE(test::stage_defect(step, 0.1, before), kTolerance);
      const Vector<double, 8> sum = before.value + step.increments() * tableau_.update;
      EXPECT_LE(relative_distance(z.value, sum), 8 * kEps);
      for (int k = 0; k < tableau_.stages(); ++k) {
        EXPECT_EQ(step.stage_time(k), 0.1 * i + tableau_.c[k] * 0.1);
      }
      EXPECT_EQ(step.last_step(), 0.1);
      EXPECT_EQ(step.branch(), step.algebraic(tableau_.stages() - 1));
    }
  }
}

// The first guess decides the cost only.
TEST_P(RungeKuttaTest, WarmStartDoesNotChangeTheStep) {
  Generator generator(2);
  Any warm(cosine(), tableau_);
  auto z = test::random_state<4>(generator);
  long warm_cost = 0;
  long cold_cost = 0;
  for (int i = 0; i < 20; ++i) {
    auto cold_z = z;
    Any cold(cosine(), tableau_);
    const StepReport cold_report = cold.step(0.1 * i, 0.1, cold_z);
    const StepReport warm_report = warm.step(0.1 * i, 0.1, z);
    ASSERT_EQ(warm_report.status, StepStatus::kOk);
    ASSERT_EQ(cold_report.status, StepStatus::kOk);
    EXPECT_LE(relative_distance(z.value, cold_z.value), 16 * kEps);
    warm_cost += warm_report.evaluations;
    cold_cost += cold_report.evaluations;
  }
  EXPECT_LE(warm_cost, cold_cost);
}

TEST_P(RungeKuttaTest, StepOfLengthZeroIsTheIdentity) {
  Generator generator(3);
  Any step(cosine(), tableau_);
  auto z = test::random_state<4>(generator);
  for (const double h : {0.0, 0.1, 0.0}) {
    const auto start = z;
    ASSERT_EQ(step.step(0, h, z).status, StepStatus::kOk);
    if (h == 0) {
      EXPECT_EQ(z.value, start.value);
    }
  }
}

TEST_P(RungeKuttaTest, CountsItsEvaluations) {
  using Counting = test::CountingSystem<Cosine>;
  const Counting system(test::uneven<scenes::VehicleCosine>());
  RungeKutta<Counting> step(system, tableau_);
  Generator generator(4);
  auto z = test::random_state<4>(generator);
  for (int i = 0; i < 5; ++i) {
    const long before = system.calls;
    const StepReport report = step.step(0, 0.1, z);
    ASSERT_EQ(report.status, StepStatus::kOk);
    EXPECT_EQ(report.evaluations, system.calls - before);
    if (!implicit()) {
      EXPECT_EQ(report.evaluations, 12);
    }
  }
}

// Linear, so one step is a matrix; no algebraic variables.
TEST_P(RungeKuttaTest, OscillatorWithoutAlgebraicVariables) {
  const Oscillator system{4};
  RungeKutta<Oscillator> step(system, tableau_);
  auto z = make_state<double, 1>(Vector<double, 1>(0.3), Vector<double, 1>(-0.8));
  constexpr int kSteps = 400;
  constexpr double kStep = 0.01;
  for (int i = 0; i < kSteps; ++i) {
    ASSERT_EQ(step.step(i * kStep, kStep, z).status, StepStatus::kOk);
  }
  const double angle = 2 * kSteps * kStep;
  const Vector<double, 2> exact(0.3 * std::cos(angle) - 0.4 * std::sin(angle),
                                -0.6 * std::sin(angle) - 0.8 * std::cos(angle));
  // Order 4 and more: (2 h)^4 times a constant below 1 and the duration.
  EXPECT_LE((z.value - exact).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(step.branch().size(), 0);
}

// The number of stages known to the compiler, and not.
template <int s>
void expect_fixed_equals_any(const std::string& name) {
  const auto tableau = test::tableau_of(name);
  const auto fixed_tableau = fixed_stages<s>(tableau);
  Generator generator(5);
  for (const double h : {0.1, 1.5}) {  // the latter by Newton's method, at least now and then
    // Stages may differ by what the iterations leave, and then by their own instability.
    const double tolerance = h < 1 ? 16 * kEps : 1e6 * kEps;
    bool newton = false;
    for (int sample = 0; sample < 40; ++sample) {
      Any any(cosine(), tableau);
      RungeKutta<Cosine, s> fixed(cosine(), fixed_tableau);
      auto a = test::random_state<4>(generator);
      auto b = a;
      for (int i = 0; i < 2; ++i) {
        const StepReport any_report = any.step(0, h, a);
        const StepReport fixed_report = fixed.step(0, h, b);
        // Where Newton's method wanders, rounding decides whether it arrives.
        if (h > 1 && (any_report.status != fixed_report.status)) break;
        ASSERT_EQ(any_report.status, fixed_report.status);
        EXPECT_LE(relative_distance(a.value, b.value), tolerance);
        newton = newton || any_report.newton;
      }
    }
    EXPECT_EQ(newton, h > 1) << h;
  }
}
TEST(FixedStagesTest, Full) { expect_fixed_equals_any<3>("gauss6"); }
TEST(FixedStagesTest, Partitioned) { expect_fixed_equals_any<3>("lobatto4"); }

// One stage alone is the same equation, whichever coupling is claimed.
TEST(CouplingTest, DiagonalMidpointIsTheFullOne) {
  const auto full_tableau = gauss_tableau<double>(1);
  const auto diagonal_tableau = composition_tableau<double>(2);
  ASSERT_EQ(full_tableau.coupling, Coupling::kFull);
  ASSERT_EQ(diagonal_tableau.coupling, Coupling::kDiagonal);
  Generator generator(6);
  Any full(cosine(), full_tableau);
  Any diagonal(cosine(), diagonal_tableau);
  auto a = test::random_state<4>(generator);
  auto b = a;
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(full.step(0.1 * i, 0.1, a).status, StepStatus::kOk);
    ASSERT_EQ(diagonal.step(0.1 * i, 0.1, b).status, StepStatus::kOk);
    EXPECT_LE(relative_distance(a.value, b.value), 16 * (i + 1) * kEps);
  }
}

// midpoint4 and the like are midpoint steps one after the other, some of them backwards.
TEST(CouplingTest, CompositionIsThatOfMidpointSteps) {
  constexpr double kStep = 0.2;
  for (const int order : {4, 6, 8}) {
    const auto tableau = composition_tableau<double>(order);
    const int count = tableau.stages();
    Generator generator(7);
    for (int sample = 0; sample < 10; ++sample) {
      Any composed(cosine(), tableau);
      auto a = test::random_state<4>(generator);
      auto b = a;
      ASSERT_EQ(composed.step(0, kStep, a).status, StepStatus::kOk);
      Gauss<Cosine, 1> midpoint(cosine());
      double t = 0;
      for (int i = 0; i < count; ++i) {
        const double h = tableau.b[i] * kStep;
        ASSERT_EQ(midpoint.step(t, h, b).status, StepStatus::kOk);
        t += h;
        const Vector<double, 8> stage = midpoint.stages().col(0);
        EXPECT_LE(relative_distance(Vector<double, 8>(composed.stages().col(i)), stage),
                  8 * (i + 1) * kEps);
      }
      EXPECT_LE(relative_distance(a.value, b.value), 8 * count * kEps);
    }
  }
}

}  // namespace
}  // namespace carnot::runge_kutta_test
