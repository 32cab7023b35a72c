// The monitor of methods of every kind: the energy of a system that depends on time, and the length
// of a path that a composition measures with steps forth and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/flow/flow.h"
#include "carnot/flow/monitor.h"
#include "carnot/scenes/kapitza_pendulum.h"
#include "carnot/system/lagrangian_system.h"
#include "testing/method_runs.h"
#include "testing/order.h"

namespace carnot::monitor_methods_test {
namespace {

using Pendulum = LagrangianSystem<scenes::KapitzaPendulum>;
using Vehicle = VelocityConstraints<scenes::Vehicle>;

constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Case {
  const char* name;
  std::vector<int> steps;
};

template <class System>
Monitor<RungeKutta<System>> monitored(const System& system,
                                      const Tableau<double>& tableau,
                                      const StepPlan& plan,
                                      State<double, System::kDof> z) {
  using Step = RungeKutta<System>;
  Step step(system, tableau);
  Monitor<Step> monitor(system, plan.start, step, z);
  const FlowReport report = flow(step, plan, z, [&](long i, const Step& done, const auto& node) {
    monitor(plan.time(i + 1), done, node);
    return true;
  });
  EXPECT_TRUE(report.completed()) << report.reason();
  return monitor;
}

class DrivenEnergyTest : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Representatives,
                         DrivenEnergyTest,
                         ::testing::Values(Case{"gauss6", {24, 32, 42, 56}},
                                           Case{"midpoint4", {80, 112, 160, 224}},
                                           Case{"lobatto4", {80, 112, 160, 224}},
                                           Case{"radau5", {40, 56, 80, 112}},
                                           Case{"dop853", {20, 28, 40, 56}}),
                         [](const auto& method) { return std::string(method.param.name); });

// H - H_0 - integral of H_t vanishes with the order of the method; H - H_0 does not.
TEST_P(DrivenEnergyTest, BalanceHasTheOrderOfTheMethod) {
  constexpr double kDuration = 2;
  constexpr double kPlateau = 1e-12;  // round-off of the steps, over terms up to 4
  constexpr double kCeiling = 1e-1;
  constexpr double kSlopeTolerance = 0.5;  // a maximum over nodes, which move with the step
  const Pendulum system(scenes::KapitzaPendulum{1, 1, 0.2, 5});
  static_assert(!Pendulum::kAutonomous);
  const auto start = make_state<double, 1>(Vector<double, 1>(0.7), Vector<double, 1>(0.4));
  const auto tableau = test::tableau_of(GetParam().name);
  std::vector<double> steps;
  std::vector<double> errors;
  for (const int count : GetParam().steps) {
    const auto monitor = monitored(system, tableau, StepPlan::equal(0, kDuration, count), start);
    EXPECT_GT(monitor.energy_drift(), 0.1);
    steps.push_back(kDuration / count);
    errors.push_back(monitor.energy_balance());
  }
  const LineFit fit = test::fit_order(steps, errors, kPlateau, kCeiling);
  EXPECT_GE(fit.points, 3);
  EXPECT_GT(fit.correlation, 0.99);
  EXPECT_NEAR(fit.slope, tableau.order, kSlopeTolerance);
}

// Without shaking both are the same, and zero up to the error of the method.
TEST(DrivenEnergyLimitTest, WithoutShakingBothAreTheSame) {
  const Pendulum system(scenes::KapitzaPendulum{1, 1, 0, 5});
  const auto start = make_state<double, 1>(Vector<double, 1>(0.7), Vector<double, 1>(0.4));
  const auto monitor =
      monitored(system, test::tableau_of("gauss16"), StepPlan::equal(0, 2, 40), start);
  EXPECT_LE(monitor.energy_drift(), 64 * kEps);
  EXPECT_LE(std::abs(monitor.energy_balance() - monitor.energy_drift()), 64 * kEps);
}

// V = 0: H is constant, so length = sqrt(2 H) T and action = H T, up to the error of the method.
using AuditOfMethodTest = test::MethodTest;
INSTANTIATE_TEST_SUITE_P(Representatives,
                         AuditOfMethodTest,
                         ::testing::ValuesIn(test::kRepresentatives),
                         test::method_test_name);

TEST_P(AuditOfMethodTest, LengthAndActionOfAFreeMotion) {
  constexpr double kDuration = 3;
  constexpr double kTolerance = 1e-6;  // order 4 and more with steps of 0.03
  const Vehicle system(test::uneven<scenes::Vehicle>());
  const auto start = test::vehicle_start(system);
  Vector<double, 2> y;
  Rate<double, 4> rate;
  const Vector<double, 4> q = start.value.head<4>();
  const Vector<double, 4> p = start.value.tail<4>();
  ASSERT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
  const double energy = system.hamiltonian(0.0, q, p, y);
  for (const double duration : {kDuration, -kDuration}) {
    const auto monitor = monitored(system, tableau_, StepPlan::equal(0, duration, 100), start);
    EXPECT_NEAR(monitor.length(), std::sqrt(2 * energy) * kDuration, kTolerance);
    EXPECT_NEAR(monitor.action(), energy * duration, kTolerance);
    EXPECT_LE(monitor.constraint_error(), 16 * kEps);
    EXPECT_EQ(monitor.energy_balance(), monitor.energy_drift());
  }
}

}  // namespace
}  // namespace carnot::monitor_methods_test
