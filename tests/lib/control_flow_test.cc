// Extremals of optimal-control scenes: against their closed forms, against the same problem with
// velocity constraints, and by what a symplectic method keeps where there is drift.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "carnot/flow/flow.h"
#include "carnot/flow/tangent_flow.h"
#include "carnot/step/gauss.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/control_forms.h"
#include "testing/control_scene_list.h"
#include "testing/distance.h"
#include "testing/order.h"
#include "testing/random_points.h"

namespace carnot::control_flow_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kStages = 3;  // order 6: no truncation left at steps of 1/100
constexpr int kSamples = 10;

// (q, p) after `steps` equal steps from z.
template <class System>
Vector<double, 2 * System::kDof> end_point(const System& system,
                                           const Vector<double, System::kDof>& q,
                                           const Vector<double, System::kDof>& p,
                                           double duration,
                                           long steps) {
  Gauss<System, kStages> method(system);
  auto z = make_state<double, System::kDof>(q, p);
  const FlowReport report = flow(method, StepPlan::equal(0, duration, steps), z);
  EXPECT_TRUE(report.completed()) << report.reason();
  return z.value;
}

// The same p0: the multipliers are in it, for H(q, p) is the same function.
template <class Controls, class Scene>
void expect_extremals_of(const Scene& constrained, const OptimalControl<Controls>& controlled) {
  constexpr double kDuration = 2;
  constexpr long kSteps = 20;
  constexpr double kRoundOff = 500 * kEps;  // 20 steps, amplified by |M| up to 10
  const VelocityConstraints<Scene> system(constrained);
  test::Generator generator(1);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = test::random_vector<Scene::kDof>(generator);
    const auto p = test::random_vector<Scene::kDof>(generator, 1.5);
    const auto expected = end_point(system, q, p, kDuration, kSteps);
    EXPECT_LE(test::largest_change(end_point(controlled, q, p, kDuration, kSteps), expected),
              kRoundOff);
  }
}
TEST(ControlFlowTest, HeisenbergWithControls) {
  const scenes::Heisenberg scene;
  using Linear = test::ControlForm<scenes::Heisenberg>;
  using General = test::ByNewton<Linear>;
  expect_extremals_of(scene, OptimalControl<Linear>(Linear{scene}));
  expect_extremals_of(scene, OptimalControl<General>(General{{scene}}));
}
TEST(ControlFlowTest, UnicycleWithControls) {
  const auto scene = test::uneven<scenes::Unicycle>();
  using General = test::ByNewton<test::ControlForm<scenes::Unicycle>>;
  expect_extremals_of(scene, OptimalControl<General>(General{{scene}}));
}

// The flow from random points, and slow ones for w -> 0, against exact(q, p, t).
template <class Scene, class Exact>
void expect_closed_form(const Scene& scene, const Exact& exact) {
  constexpr int n = Scene::kDof;
  constexpr double kDuration = 1;
  constexpr double kRoundOff = 500 * kEps;  // values up to 10, 100 steps
  const OptimalControl<Scene> system(scene);
  test::Generator generator(2);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = test::random_vector<n>(generator);
    Vector<double, n> p = test::random_vector<n>(generator, 1.5);
    if (i < 3) p[n - 1] = std::array{0.0, 1e-9, -1e-4}[i];
    const Vector<double, 2 * n> end = end_point(system, q, p, kDuration, 100);
    EXPECT_LE(test::largest_change(end, exact(q, p, kDuration)), kRoundOff) << p.transpose();
    Vector<double, 2 * n> start;
    start << q, p;
    EXPECT_LE(test::largest_change(exact(q, p, 0.0), start), 4 * kEps);
  }
}
TEST(ControlFlowTest, GrushinClosedForm) {
  expect_closed_form(scenes::Grushin{}, scenes::Grushin::closed_form);
}
TEST(ControlFlowTest, BrockettClosedForm) {
  expect_closed_form(scenes::Brockett{}, scenes::Brockett::closed_form);
}
// Weights with complex, real and double exponents, and none.
TEST(ControlFlowTest, LinearQuadraticRegulatorClosedForm) {
  for (const auto& [a, b] : {std::pair{1.0, 1.0}, {0.5, 2.0}, {1.0, 2.0}, {0.0, 1.0}, {0.0, 0.0}}) {
    const scenes::DoubleIntegrator scene{a, b};
    expect_closed_form(
        scene, [&](const auto& q, const auto& p, double t) { return scene.closed_form(q, p, t); });
  }
}
// From rest at 0 to rest at 1 in time T with least effort: u = 6 (1 - 2 t/T)/T^2, action 6/T^3.
TEST(ControlFlowTest, LeastEffortIsACubic) {
  const OptimalControl<scenes::DoubleIntegrator> system{{0, 0}};
  const Vector<double, 4> end = end_point(system, {0, 0}, {12, 6}, 1, 4);
  EXPECT_LE(test::largest_change(end, Vector<double, 4>(1, 0, 12, -6)), 64 * kEps);
}

// H_t of a scene that depends on time: f = a(t) u, a = 1 + cos(t)/2, l = u^2/2, so that p is
// constant and q = q0 + p (integral of a^2).
struct Tide {
  static constexpr int kDof = 1;
  static constexpr int kControls = 1;
  static constexpr bool kTimeDependent = true;

  template <class T>
  [[nodiscard]] Vector<T, 1> dynamics(const T& t,
                                      const Vector<T, 1>& /*q*/,
                                      const Vector<T, 1>& u) const {
    using std::cos;
    return Vector<T, 1>((constant<T>(1) + constant<T>(0.5) * cos(t)) * u[0]);
  }
  template <class T>
  [[nodiscard]] T running_cost(const T& /*t*/,
                               const Vector<T, 1>& /*q*/,
                               const Vector<T, 1>& u) const {
    return constant<T>(0.5) * u[0] * u[0];
  }
};
TEST(ControlFlowTest, TimeDependentDynamics) {
  using System = OptimalControl<Tide>;
  static_assert(!System::kAutonomous && OptimalControl<scenes::Boat>::kAutonomous);
  const System system{{}};
  constexpr double kTime = 3;
  const auto end = end_point(system, Vector<double, 1>(0.2), Vector<double, 1>(0.7), kTime, 300);
  const double square = kTime + std::sin(kTime) + kTime / 8 + std::sin(2 * kTime) / 16;
  EXPECT_NEAR(end[0], 0.2 + 0.7 * square, 32 * kEps);
  EXPECT_EQ(end[1], 0.7);
}

// Drift: what remains of the laws of a symplectic method.
template <class Scene>
class DriftTest : public ::testing::Test {
 protected:
  using System = OptimalControl<Scene>;
  using Z = Vector<double, 4>;
  const System system_{test::uneven<Scene>()};
  const Vector<double, 2> q_{0.4, -0.3};
  const Vector<double, 2> p_{0.8, 0.6};

  [[nodiscard]] double energy(const Z& z) const {
    Vector<double, Scene::kControls> u = Vector<double, Scene::kControls>::Zero();
    Vector<double, 4> z_dot;
    EXPECT_EQ(phase_rate(system_, 0.0, z, u, z_dot), RateStatus::kOk);
    return system_.hamiltonian(
        0.0, Vector<double, 2>(z.head<2>()), Vector<double, 2>(z.tail<2>()), u);
  }
};
using DriftScenes = ::testing::Types<scenes::Pendulum, scenes::Boat>;  // nonlinear ones
TYPED_TEST_SUITE(DriftTest, DriftScenes, test::SceneNames);

TYPED_TEST(DriftTest, EnergyIsConservedByTheFlow) {
  Vector<double, 4> start;
  start << this->q_, this->p_;
  const auto end = end_point(this->system_, this->q_, this->p_, 2, 200);
  EXPECT_NEAR(this->energy(end), this->energy(start), 200 * kEps);  // values up to 10, 200 steps
}

TYPED_TEST(DriftTest, OrderBySlope) {
  constexpr double kSlopeTolerance = 0.15;
  const auto exact = end_point(this->system_, this->q_, this->p_, 2, 200);
  std::vector<double> step;
  std::vector<double> error;
  for (const long steps : {4L, 6L, 8L, 12L, 16L, 24L}) {
    step.push_back(2.0 / static_cast<double>(steps));
    error.push_back(
        test::largest_change(end_point(this->system_, this->q_, this->p_, 2, steps), exact));
  }
  const LineFit fit = test::fit_order(step, error, 1e-13, 1e-2);
  EXPECT_GE(fit.points, 3);
  EXPECT_GT(fit.correlation, 0.99);
  EXPECT_NEAR(fit.slope, 2 * kStages, kSlopeTolerance);
}

TYPED_TEST(DriftTest, TangentIsSymplectic) {
  constexpr double kDefect = 50 * kEps;  // round-off of the products, per |M|^2
  Gauss<typename TestFixture::System, kStages> method(this->system_);
  auto z = make_state<double, 2>(this->q_, this->p_);
  Compensated<Matrix<double, 4, 4>> m{Matrix<double, 4, 4>::Identity(),
                                      Matrix<double, 4, 4>::Zero()};
  const auto go_on = [](long, const auto&, const auto&) { return true; };
  ASSERT_TRUE(tangent_flow(method, StepPlan::equal(0, 2, 10), z, m, go_on).completed());
  EXPECT_LE(symplecticity_defect(m.value), kDefect * std::max(1.0, m.value.squaredNorm()));
}

// Without control the pendulum keeps its own energy.
TEST(PendulumFlowTest, SwingsFreelyWithoutMomentum) {
  const OptimalControl<scenes::Pendulum> system{{}};
  const auto energy = [](const auto& z) { return 0.5 * z[1] * z[1] - std::cos(z[0]); };
  const auto end = end_point(system, {1, 0.5}, {0, 0}, 10, 1000);
  EXPECT_EQ(end.tail<2>(), (Vector<double, 2>(0, 0)));
  EXPECT_NEAR(energy(end), energy(Vector<double, 2>(1, 0.5)), 64 * kEps);
}

// p is known exactly, and with it y = (H - h(|p|)) / (shear p_x), h = u1^2/2 + 3 u1^4/4. On the
// branch that it starts on, ahead or backwards, the boat goes the same way.
class BoatFlowTest : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Branches, BoatFlowTest, ::testing::Values(1.0, -1.0));

TEST_P(BoatFlowTest, FollowsItsClosedFormOnItsBranch) {
  constexpr double kRoundOff = 200 * kEps;  // 400 steps
  const scenes::Boat scene = test::uneven<scenes::Boat>();
  const OptimalControl<scenes::Boat> system(scene);
  Gauss<OptimalControl<scenes::Boat>, kStages> method(system);
  const Vector<double, 2> q(0.4, -0.3);
  const Vector<double, 2> p(0.8, 0.6);
  const double thrust = 0.6823278038280193;  // the root of u + u^3 = |p| = 1
  const double heading = std::atan2(p[1], p[0]);
  const bool ahead = GetParam() > 0;
  method.start_on({GetParam() * thrust, ahead ? heading : heading + std::numbers::pi});
  const auto rest = [](double u) { return 0.5 * u * u + 0.75 * u * u * u * u; };
  const double h = scene.shear * p[0] * q[1] + rest(thrust);
  auto z = make_state<double, 2>(q, p);
  const StepPlan plan = StepPlan::equal(0, 4, 400);
  const auto watch = [&](long i, const auto& step, const auto& node) {
    const double t = plan.time(i + 1);
    EXPECT_EQ(node.value[2], p[0]);
    EXPECT_NEAR(node.value[3], p[1] - scene.shear * p[0] * t, kRoundOff);
    const double size = std::hypot(node.value[2], node.value[3]);
    double u = thrust;
    for (int k = 0; k < 8; ++k) u -= (u + u * u * u - size) / (1 + 3 * u * u);
    EXPECT_NEAR(node.value[1], (h - rest(u)) / (scene.shear * p[0]), kRoundOff);
    EXPECT_EQ(step.algebraic(kStages - 1)[0] > 0, ahead);
    return true;
  };
  ASSERT_TRUE(flow(method, plan, z, watch).completed());
}

}  // namespace
}  // namespace carnot::control_flow_test
