#include "carnot/flow/monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/flow/flow.h"
#include "carnot/step/gauss.h"
#include "testing/runs.h"

namespace carnot::monitor_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

struct Measured {
  double action = 0;
  double length = 0;
  double energy_drift = 0;
  double constraint_error = 0;
  double energy = 0;
};

// Runs gauss16 over the plan and measures.
template <class Scene>
Measured measure(const Scene& scene,
                 const StepPlan& plan,
                 const State<double, Scene::kDof>& start) {
  constexpr int n = Scene::kDof;
  using System = VelocityConstraints<Scene>;
  using Step = Gauss<System, 8>;
  const System system(scene);
  Step step(system);
  auto z = start;
  Monitor<Step> monitor(system, plan.start, step, z);
  const FlowReport report = flow(step, plan, z, [&](long i, const Step& done, const auto& node) {
    monitor(plan.time(i + 1), done, node);
    return true;
  });
  EXPECT_TRUE(report.completed());
  Vector<double, System::kAlgebraic> y;
  Rate<double, n> rate;
  const Vector<double, n> q = start.value.template head<n>();
  const Vector<double, n> p = start.value.template tail<n>();
  EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
  return {monitor.action(),
          monitor.length(),
          monitor.energy_drift(),
          monitor.constraint_error(),
          system.hamiltonian(0.0, q, p, y)};
}

template <class Scene>
class MonitorTest : public ::testing::Test {};
TYPED_TEST_SUITE(MonitorTest, test::Scenes, test::SceneNames);

template <class Scene>
class FreeMotionTest : public ::testing::Test {};
TYPED_TEST_SUITE(FreeMotionTest, test::FreeScenes, test::SceneNames);

// V = 0: L = H along the extremal, so action = H T and length = sqrt(2 H) T.
TYPED_TEST(FreeMotionTest, ActionAndLength) {
  constexpr double kTime = 3;
  constexpr double kTolerance = 256 * kEps;  // 30 steps of 8 stages with values up to 10
  static_assert(!HasPotential<TypeParam>);
  test::Generator generator(1);
  for (int sample = 0; sample < 5; ++sample) {
    const auto start = test::random_state<TypeParam::kDof>(generator);
    const Measured m = measure(test::uneven<TypeParam>(), StepPlan::equal(0, kTime, 30), start);
    const double size = std::max(1.0, m.energy * kTime);
    EXPECT_NEAR(m.action, m.energy * kTime, kTolerance * size);
    EXPECT_NEAR(m.length, std::sqrt(2 * m.energy) * kTime, kTolerance * size);
    EXPECT_NEAR(m.length * m.length / (2 * kTime), m.action, 2 * kTolerance * size);
    EXPECT_LE(m.energy_drift, kTolerance * size);
    EXPECT_LE(m.constraint_error, 16 * kEps);
  }
}

// Backwards in time the action changes its sign, the length does not.
TYPED_TEST(MonitorTest, Backwards) {
  test::Generator generator(2);
  const auto start = test::random_state<TypeParam::kDof>(generator);
  const auto mirrored = test::flipped<double, TypeParam::kDof>(start);
  const auto scene = test::uneven<TypeParam>();
  const Measured forth = measure(scene, StepPlan::equal(0, 2, 20), start);
  const Measured back = measure(scene, StepPlan::equal(0, -2, 20), mirrored);
  EXPECT_NEAR(back.action, -forth.action, 256 * kEps);
  EXPECT_NEAR(back.length, forth.length, 256 * kEps);
}

// action = integral of L, by Simpson's rule over L at fine nodes.
TEST(AuditPotentialTest, ActionIsTheIntegralOfTheLagrangian) {
  using System = VelocityConstraints<scenes::VehicleCosine>;
  constexpr long kSteps = 400;
  constexpr double kTime = 3;
  constexpr double kSimpsonError = 1e-9;  // (T / steps)^4 times fourth derivatives up to 10
  const System system{{}};
  const auto start = test::vehicle_start(system);
  Gauss<System, 8> step(system);
  auto z = start;
  double sum = 0;
  const auto lagrangian = [&](const auto& node) {
    const Vector<double, 4> q = node.value.template head<4>();
    const Vector<double, 4> p = node.value.template tail<4>();
    Vector<double, 2> y;
    Rate<double, 4> rate;
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    return system.lagrangian(q, rate.q_dot);
  };
  sum = lagrangian(z);
  const StepPlan plan = StepPlan::equal(0, kTime, kSteps);
  const auto watch = [&](long i, const auto&, const auto& node) {
    const double weight = i + 1 == kSteps ? 1 : (i % 2 == 0 ? 4 : 2);
    sum += weight * lagrangian(node);
    return true;
  };
  ASSERT_TRUE(flow(step, plan, z, watch).completed());
  const double simpson = sum * plan.step / 3;
  const Measured m = measure(scenes::VehicleCosine{}, StepPlan::equal(0, kTime, 30), start);
  EXPECT_NEAR(m.action, simpson, kSimpsonError);
}

// A crude method drifts, and the monitor says so.
TEST(AuditDriftTest, SeesTheEnergyErrorOfACoarseRun) {
  using System = VelocityConstraints<scenes::VehicleCosine>;
  using Step = Gauss<System, 1>;
  const System system{{}};
  auto z = test::vehicle_start(system);
  Step step(system);
  Monitor<Step> monitor(system, 0, step, z);
  const StepPlan plan = StepPlan::equal(0, 3, 15);
  ASSERT_TRUE(flow(step, plan, z, [&](long i, const Step& done, const auto& node) {
                monitor(plan.time(i + 1), done, node);
                return true;
              }).completed());
  EXPECT_GT(monitor.energy_drift(), 1e-4);
  EXPECT_LT(monitor.energy_drift(), 1e-1);
  EXPECT_LE(monitor.constraint_error(), 16 * kEps);  // yet it stays admissible
}

}  // namespace
}  // namespace carnot::monitor_test
