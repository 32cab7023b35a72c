// RATTLE on the rod with a skate and on the spherical pendulum: order, geometry, constraints, and
// reference values found by other methods.
#include "carnot/step/rattle.h"

#include <gtest/gtest.h>

#include "carnot/flow/monitor.h"
#include "testing/holonomic_laws.h"
#include "testing/reference.h"

namespace carnot::rattle_test {
namespace {

using RodSkateRuns = test::HolonomicRuns<test::RodSkatePair>;
using PendulumRuns = test::HolonomicRuns<test::PendulumPair>;

template <class Runs>
class RattleTest : public ::testing::Test {};
using Pairs = ::testing::Types<RodSkateRuns, PendulumRuns>;
TYPED_TEST_SUITE(RattleTest, Pairs);

TYPED_TEST(RattleTest, OrderTwo) { test::expect_order<TypeParam>(2, {20, 28, 40, 56}); }
TYPED_TEST(RattleTest, OrderFourByComposition) {
  test::expect_order<TypeParam>(4, {10, 14, 20, 28});
}
TYPED_TEST(RattleTest, OrderSixByComposition) { test::expect_order<TypeParam>(6, {8, 10, 13, 17}); }
TYPED_TEST(RattleTest, SameMotionAsTheReducedScene) {
  test::expect_same_motion_as_reduced<TypeParam>();
}
TYPED_TEST(RattleTest, SymplecticOnTheManifold) {
  test::expect_symplectic_on_manifold<TypeParam>();
}
TYPED_TEST(RattleTest, TangentOfTheMap) { test::expect_tangent_of_the_map<TypeParam>(); }
TYPED_TEST(RattleTest, Reversible) { test::expect_reversible<TypeParam>(); }

// The rod falls for a time of 10; the pendulum swings a hundred times.
TEST(RattleConstraintsTest, RodSkateOverManySteps) {
  test::expect_constraints_at_round_off<RodSkateRuns>(1e-4, 100000);
}
TEST(RattleConstraintsTest, PendulumOverManySteps) {
  test::expect_constraints_at_round_off<PendulumRuns>(0.01, 100000);
}

TEST(RattleEnergyTest, PendulumDoesNotDrift) {
  test::expect_bounded_energy<PendulumRuns>(0.1, 50000);
}

// The part of p0 along Dh(q0) changes nothing: the impulse takes it away.
TEST(RattleTest, ForgetsMomentaAcrossTheManifold) {
  constexpr double kTolerance = 1e-13;  // a few roundings of p over h
  test::Generator generator(8);
  const auto start = PendulumRuns::random_start(generator);
  auto z = start;
  auto pushed = start;
  pushed.value.tail<3>() += 0.3 * start.value.head<3>();
  ASSERT_TRUE(PendulumRuns::run(2, 0.1, 1, z).completed());
  ASSERT_TRUE(PendulumRuns::run(2, 0.1, 1, pushed).completed());
  EXPECT_LE(test::relative_distance(pushed.value, z.value), kTolerance);
}

// A start near the manifold is on it after one step.
TEST(RattleTest, ReturnsToTheManifold) {
  test::Generator generator(9);
  auto z = PendulumRuns::random_start(generator);
  z.value += 1e-3 * test::random_vector<6>(generator);
  EXPECT_GT(PendulumRuns::measure(z).holonomic, 1e-4);
  ASSERT_TRUE(PendulumRuns::run(2, 0.1, 1, z).completed());
  EXPECT_LE(PendulumRuns::measure(z).holonomic, 16 * epsilon<double>());
  EXPECT_LE(PendulumRuns::measure(z).hidden, 16 * epsilon<double>());
}

// What a step tells of itself: the nodes join, the stages are midpoints that obey the velocity
// constraint, the impulses explain the momenta.
TEST(RattleTest, StagesAndNodesOfAStep) {
  constexpr double kTolerance = 64 * epsilon<double>();
  constexpr double kStep = 0.1;
  const RodSkateRuns::System system(test::RodSkatePair::kFull);
  const Tableau<double> tableau = composition_tableau<double>(4);
  RodSkateRuns::Method method(system, tableau);
  test::Generator generator(10);
  const auto start = RodSkateRuns::random_start(generator);
  auto z = start;
  ASSERT_EQ(method.step(1, kStep, z).status, StepStatus::kOk);
  EXPECT_EQ(method.last_step(), kStep);
  EXPECT_EQ(method.node(0), start.value);
  EXPECT_EQ(method.node(tableau.stages()), z.value);
  EXPECT_DOUBLE_EQ(method.node_time(0), 1);
  EXPECT_DOUBLE_EQ(method.node_time(tableau.stages()), 1 + kStep);
  for (int i = 0; i < tableau.stages(); ++i) {
    const auto& scene = test::RodSkatePair::kFull;
    EXPECT_DOUBLE_EQ(method.stage_time(i), 0.5 * (method.node_time(i) + method.node_time(i + 1)));
    Vector<double, 8> before = method.node(i);
    Vector<double, 8> after = method.node(i + 1);
    const Vector<double, 4> q0 = before.head<4>();
    const Vector<double, 4> q1 = after.head<4>();
    apply_impulse(holonomic_jacobian(scene, q0), method.impulse_before(i), before);
    apply_impulse(holonomic_jacobian(scene, q1),
                  RodSkateRuns::Method::Impulse(-method.impulse_after(i)),
                  after);
    const Vector<double, 8> midpoint = 0.5 * (before + after);
    EXPECT_LE(test::relative_distance(midpoint, Vector<double, 8>(method.stages().col(i))),
              kTolerance);
    EXPECT_LE(test::relative_distance(Vector<double, 8>(after - before),
                                      Vector<double, 8>(method.increments().col(i))),
              kTolerance);
    const Vector<double, 4> v = method.increments().col(i).head<4>() / (kStep * tableau.b[i]);
    EXPECT_NEAR(system.constraint(Vector<double, 4>(midpoint.head<4>()), v)[0], 0, kTolerance);
  }
}

// The action of the audit has the order of the method, though the stages leave the manifold.
TEST(RattleTest, ActionHasTheOrderOfTheMethod) {
  const PendulumRuns::System system(test::PendulumPair::kFull);
  const Tableau<double> tableau = composition_tableau<double>(4);
  const auto action = [&](long steps) {
    test::Generator generator(11);
    auto z = PendulumRuns::random_start(generator);
    PendulumRuns::Method method(system, tableau);
    Monitor<PendulumRuns::Method> audit(system, 0, method, z);
    const StepPlan plan = StepPlan::equal(0, 2, steps);
    const auto watch = [&](long i, const auto& step, const auto& node) {
      audit(plan.time(i + 1), step, node);
      return true;
    };
    EXPECT_TRUE(flow(method, plan, z, watch).completed());
    EXPECT_LE(audit.holonomic_error(), 32 * epsilon<double>());
    return audit.action();
  };
  const double exact = action(320);  // 8^4 times the accuracy
  std::vector<double> steps;
  std::vector<double> errors;
  for (const long count : {14, 20, 28, 40}) {
    steps.push_back(1.0 / static_cast<double>(count));
    errors.push_back(std::abs(action(count) - exact));
  }
  EXPECT_NEAR(test::fit_order(steps, errors, 1e-13, 1e-2).slope, 4, 0.25);
}

// The falling rod against values of 34 digits.
TEST(RodSkateReferenceTest, AllTimes) {
  constexpr double kTolerance = 1e-12;  // rounding of p0 and of the steps, amplified up to 1e3
  const test::Json data = test::own_reference("rod_skate.json");
  ASSERT_FALSE(data.is_null());
  const test::Json& values = data.at("values");
  const RodSkateRuns::System system(test::RodSkatePair::kFull);
  int compared = 0;
  for (const test::Json& value : values) {
    const double time = test::number(value.at("T"));
    auto z = make_state<double, 4>(test::numbers<4>(values[0].at("q")),
                                   test::numbers<4>(values[0].at("p")));
    const long steps = std::lround(40 * time);
    if (time > 0) {
      ASSERT_TRUE(RodSkateRuns::run(8, time, steps, z).completed());
    }
    const Vector<double, 4> q = z.value.head<4>();
    const Vector<double, 4> p = z.value.tail<4>();
    EXPECT_LE(test::relative_distance(q, test::numbers<4>(value.at("q"))), kTolerance)
        << "T = " << time;
    EXPECT_LE(test::relative_distance(p, test::numbers<4>(value.at("p"))), kTolerance)
        << "T = " << time;
    Vector<double, 3> u;
    Rate<double, 4> rate;
    Vector<double, 1> lambda;
    ASSERT_EQ(system.rate(time, q, p, u, rate), RateStatus::kOk);
    ASSERT_EQ(system.multipliers(time, q, p, u, lambda), RateStatus::kOk);
    const auto velocity = test::numbers<4>(value.at("qdot"));
    EXPECT_LE(test::relative_distance(rate.q_dot, velocity), 10 * kTolerance) << "T = " << time;
    EXPECT_NEAR(lambda[0], test::number(value.at("lambda")), 10 * kTolerance) << "T = " << time;
    EXPECT_NEAR(system.hamiltonian(time, q, p, u), test::number(value.at("H")), 10 * kTolerance);
    ++compared;
  }
  EXPECT_EQ(compared, 4);
}

}  // namespace
}  // namespace carnot::rattle_test
