// Lagrangian scenes against closed forms, other routes, and what they say of themselves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "carnot/flow/flow.h"
#include "carnot/scene/describe_scene.h"
#include "carnot/scenes/appell.h"
#include "carnot/scenes/kapitza_pendulum.h"
#include "carnot/scenes/relativistic_particle.h"
#include "carnot/step/gauss.h"
#include "carnot/system/lagrangian_system.h"
#include "testing/random_points.h"

namespace carnot::lagrangian_scenes_test {
namespace {

constexpr double kEps = epsilon<double>();
constexpr double kPi = std::numbers::pi;

// ----- relativistic particle

using Particle = LagrangianSystem<scenes::RelativisticParticle>;
constexpr scenes::RelativisticParticle kParticle{1.3, 2, -0.7, 1.5};
using Q = Vector<double, 3>;

Q kinetic_momentum(const Q& q, const Q& p) {
  const double half = 0.5 * kParticle.charge * kParticle.field;
  return {p[0] + half * q[1], p[1] - half * q[0], p[2]};
}

// v = pi/(gamma m), H = gamma m c^2, up to speeds near that of light.
TEST(RelativisticParticleTest, LegendreTransformInClosedForm) {
  const Particle system(kParticle);
  const double c = kParticle.light;
  test::Generator generator(1);
  for (const double size : {1e-3, 1.0, 30.0}) {
    for (int sample = 0; sample < 10; ++sample) {
      const Q q = test::random_vector<3>(generator, size);
      const Q p = test::random_vector<3>(generator, size);
      const Q pi = kinetic_momentum(q, p);
      const double gamma_mass =
          std::sqrt(kParticle.mass * kParticle.mass + pi.squaredNorm() / (c * c));
      Q v(0, 0, 0);
      Rate<double, 3> rate;
      ASSERT_EQ(system.rate(0.0, q, p, v, rate), RateStatus::kOk);
      // p - e A and 1 - |v|^2/c^2 cancel: gamma^2 or 1000 in the worst case.
      const double tolerance = 1e3 * kEps * c;
      EXPECT_LE((v - pi / gamma_mass).norm(), tolerance);
      EXPECT_EQ(rate.q_dot, v);
      const double h = system.hamiltonian(0.0, q, p, v);
      EXPECT_NEAR(h / (gamma_mass * c * c), 1, 1e3 * kEps);
      // The Lorentz force: pi' = e v x B.
      const double half = 0.5 * kParticle.charge * kParticle.field;
      const Q force(rate.p_dot[0] + half * v[1], rate.p_dot[1] - half * v[0], rate.p_dot[2]);
      EXPECT_LE((force - 2 * half * Q(v[1], -v[0], 0)).norm(), tolerance);
    }
  }
}

TEST(RelativisticParticleTest, MovesOnAHelix) {
  constexpr double kDuration = 20;
  constexpr double kTolerance = 1e-12;  // of the method, order 8, and of 400 steps
  test::Generator generator(2);
  for (const double field : {1.5, 0.0}) {
    scenes::RelativisticParticle scene = kParticle;
    scene.field = field;
    const Particle system(scene);
    Gauss<Particle, 4> method(system);
    for (int sample = 0; sample < 3; ++sample) {
      const Q q = test::random_vector<3>(generator);
      const Q p = test::random_vector<3>(generator, 2);
      auto z = make_state<double, 3>(q, p);
      method.start_on(Q(0, 0, 0));
      const auto report = flow(method, StepPlan::equal(0, kDuration, 400), z);
      ASSERT_TRUE(report.completed()) << report.reason();
      const Vector<double, 6> exact = scene.closed_form(q, p, kDuration);
      EXPECT_LE((z.value - exact).norm(), kTolerance * exact.norm());
      // Invariants, with v of the end.
      Q v = method.branch();
      Rate<double, 3> rate;
      const Q q1 = z.value.head<3>();
      const Q p1 = z.value.tail<3>();
      ASSERT_EQ(system.rate(0.0, q1, p1, v, rate), RateStatus::kOk);
      Q v0(0, 0, 0);
      ASSERT_EQ(system.rate(0.0, q, p, v0, rate), RateStatus::kOk);
      EXPECT_NEAR(
          system.hamiltonian(0.0, q1, p1, v), system.hamiltonian(0.0, q, p, v0), kTolerance);
      EXPECT_EQ(p1[2], p[2]);
      EXPECT_NEAR(q1[0] * p1[1] - q1[1] * p1[0], q[0] * p[1] - q[1] * p[0], kTolerance);
      EXPECT_NEAR(v.norm(), v0.norm(), kTolerance);
    }
  }
}

// ----- Kapitza pendulum

using Pendulum = LagrangianSystem<scenes::KapitzaPendulum>;
using One = Vector<double, 1>;
static_assert(!Pendulum::kAutonomous && Particle::kAutonomous);

// theta'' = -(gravity + Y'') sin(theta)/length by a fourth-order method: no Lagrangian in it.
double by_newton(const scenes::KapitzaPendulum& s, double theta, double duration, int steps) {
  using Z = Vector<long double, 2>;
  const auto f = [&](long double t, const Z& z) {
    const long double w = s.frequency;
    const long double pivot = -s.amplitude * w * w * std::cos(w * t);  // Y''
    return Z(z[1], -(s.gravity + pivot) * std::sin(z[0]) / s.length);
  };
  Z z(theta, 0);
  const long double h = static_cast<long double>(duration) / steps;
  for (int i = 0; i < steps; ++i) {
    const long double t = i * h;
    const Z a = f(t, z);
    const Z b = f(t + h / 2, z + h / 2 * a);
    const Z c = f(t + h / 2, z + h / 2 * b);
    const Z d = f(t + h, z + h * c);
    z += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return static_cast<double>(z[0]);
}

// From rest at theta and t = 0, where Y' = 0 and so p = 0.
template <class Observer>
double swing(const scenes::KapitzaPendulum& scene,
             double theta,
             double duration,
             long steps,
             const Observer& observe) {
  const Pendulum system(scene);
  Gauss<Pendulum, 4> method(system);
  auto z = make_state<double, 1>(One(theta), One(0));
  const auto report = flow(method, StepPlan::equal(0, duration, steps), z, observe);
  EXPECT_TRUE(report.completed()) << report.reason();
  return z.value[0];
}

TEST(KapitzaPendulumTest, MovesByNewtonsLaw) {
  const scenes::KapitzaPendulum scene{1.2, 0.9, 0.15, 11};
  const auto go_on = [](long, const auto&, const auto&) { return true; };
  // RK4 with 1/2000 of a shake per step leaves (11/2000)^4 times derivatives: below 1e-9.
  for (const double theta : {0.5, 2.0, 3.0}) {
    EXPECT_NEAR(swing(scene, theta, 3, 300, go_on), by_newton(scene, theta, 3, 6000), 1e-9);
  }
}

// H is not conserved, but dH/dt = H_t: what H has gained is the integral of H_t, by the quadrature
// of the method itself over its stages.
TEST(KapitzaPendulumTest, EnergyChangesByThePowerOfThePivot) {
  using J = Jet<double, 1>;
  const scenes::KapitzaPendulum scene{1.2, 0.9, 0.15, 11};
  const Pendulum system(scene);
  const auto energy = [&](double t, const auto& z) {
    One v(0);
    Rate<double, 1> rate;
    EXPECT_EQ(system.rate(t, One(z.value[0]), One(z.value[1]), v, rate), RateStatus::kOk);
    return system.hamiltonian(t, One(z.value[0]), One(z.value[1]), v);
  };
  const double start = -scene.gravity * scene.length * std::cos(2.0);
  double gained = 0;
  double worst = 0;
  double swung = 0;
  swing(scene, 2, 6, 1200, [&](long i, const auto& step, const auto& z) {
    const double h = step.last_step();
    for (int k = 0; k < 4; ++k) {
      const double t = step.stage_time(k);
      const double theta = step.stages()(0, k);
      const double v = step.algebraic(k)[0];
      const J power = system.hamiltonian(J(t, 0),
                                         Vector<J, 1>(J(theta)),
                                         Vector<J, 1>(J(step.stages()(1, k))),
                                         Vector<J, 1>(J(v)));
      const double pivot =
          -scene.amplitude * scene.frequency * scene.frequency * std::cos(scene.frequency * t);
      EXPECT_NEAR(power.v[0], -scene.length * pivot * v * std::sin(theta), 1e3 * kEps);
      gained += h * step.tableau().b[k] * power.v[0];
    }
    const double h_now = energy(h * static_cast<double>(i + 1), z);
    worst = std::max(worst, std::abs(h_now - start - gained));
    swung = std::max(swung, std::abs(h_now - start));
    return true;
  });
  EXPECT_GE(swung, 0.5);
  EXPECT_LE(worst, 1e-12);  // order 8 with a shake in 114 steps, and the round-off of 1200 steps
}

TEST(KapitzaPendulumTest, WithoutShakingEnergyIsConserved) {
  const scenes::KapitzaPendulum scene{1.2, 0.9, 0, 11};
  const Pendulum system(scene);
  const double start = -scene.gravity * scene.length * std::cos(2.0);
  double drift = 0;
  swing(scene, 2, 20, 400, [&](long, const auto& step, const auto& z) {
    const One p(z.value[1]);
    One v = step.branch();
    Rate<double, 1> rate;
    EXPECT_EQ(system.rate(0.0, One(z.value[0]), p, v, rate), RateStatus::kOk);
    drift = std::max(drift, std::abs(system.hamiltonian(0.0, One(z.value[0]), p, v) - start));
    return true;
  });
  EXPECT_LE(drift, 1e-13);
}

// amplitude^2 frequency^2 > 2 gravity length: upside down is stable.
TEST(KapitzaPendulumTest, StandsUpsideDownWhereItIsShakenEnough) {
  const auto farthest = [](double amplitude) {
    scenes::KapitzaPendulum scene;
    scene.amplitude = amplitude;
    double angle = 0;
    swing(scene, kPi - 0.05, 30, 3000, [&](long, const auto&, const auto& z) {
      angle = std::max(angle, std::abs(z.value[0] - kPi));
      return true;
    });
    return angle;
  };
  EXPECT_LE(farthest(0.1), 0.1);   // 4 against 2
  EXPECT_GE(farthest(0.05), 2.0);  // 1 against 2
}

// ----- what the scenes say of themselves

template <class Scene>
class LagrangianSceneInfoTest : public ::testing::Test {};
using Scenes =
    ::testing::Types<scenes::Appell, scenes::RelativisticParticle, scenes::KapitzaPendulum>;
TYPED_TEST_SUITE(LagrangianSceneInfoTest, Scenes);

// q -> D q, v -> D v leaves L, and |g|, as they are.
TYPED_TEST(LagrangianSceneInfoTest, MirrorsAreSymmetries) {
  constexpr int kDof = TypeParam::kDof;
  const TypeParam scene;
  const LagrangianSystem<TypeParam> system(scene);
  const SceneInfo info = describe_scene(scene);
  EXPECT_EQ(info.kind, "Lagrangian");
  EXPECT_EQ(info.configuration.size(), kDof);
  EXPECT_FALSE(info.symmetries.mirrors.empty());
  test::Generator generator(4);
  for (const auto& mirror : info.symmetries.mirrors) {
    ASSERT_EQ(mirror.size(), kDof);
    const Vector<double, kDof> d = vector_at<kDof>(mirror.data());
    for (int sample = 0; sample < 5; ++sample) {
      const auto q = test::random_vector<kDof>(generator);
      const auto v = test::random_vector<kDof>(generator, 0.5);
      const Vector<double, kDof> mirrored_q = d.cwiseProduct(q);
      const Vector<double, kDof> mirrored_v = d.cwiseProduct(v);
      EXPECT_NEAR(
          system.lagrangian(0.3, mirrored_q, mirrored_v), system.lagrangian(0.3, q, v), 8 * kEps);
      EXPECT_NEAR(system.constraint(mirrored_q, mirrored_v).norm(),
                  system.constraint(q, v).norm(),
                  4 * kEps);
    }
  }
}

TYPED_TEST(LagrangianSceneInfoTest, ParametersHaveDefaultsInTheirRanges) {
  EXPECT_NO_THROW(validate(TypeParam{}));
  for (const auto& parameter : TypeParam::parameters()) {
    TypeParam scene;
    scene.*parameter.value = std::nan("");
    EXPECT_THROW(validate(scene), std::invalid_argument) << parameter.name;
  }
}

}  // namespace
}  // namespace carnot::lagrangian_scenes_test
