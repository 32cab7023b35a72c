#include "carnot/scenes/magnetic_particle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "carnot/flow/flow.h"
#include "carnot/scene/describe_scene.h"
#include "carnot/step/runge_kutta.h"
#include "carnot/system/generalized_hamiltonian.h"
#include "carnot/tableau/gauss_tableau.h"
#include "testing/distance.h"
#include "testing/generalized_scenes.h"
#include "testing/order.h"
#include "testing/runs.h"

namespace carnot::magnetic_particle_test {
namespace {

using scenes::MagneticParticle;
using System = GeneralizedHamiltonian<MagneticParticle>;
using Pair = Vector<double, 2>;
using test::distance;
using test::norm;

constexpr double kEps = std::numeric_limits<double>::epsilon();
const MagneticParticle kTrapped{1.3, 0.7, 2, 0.4};
const MagneticParticle kFree{1.3, 0.7, 2, 0};

// p = m (1 + |w|^2 / (2 c^2)) w + b (-y, x)/2.
Pair momentum(const MagneticParticle& scene, const Pair& x, const Pair& w) {
  const double inertia = scene.inertia(w);
  const double half_field = 0.5 * scene.field;
  return {inertia * w[0] - half_field * x[1], inertia * w[1] + half_field * x[0]};
}

template <class T>
Vector<T, 2> velocity(const System& system, const Vector<T, 4>& state) {
  Vector<T, 2> w = filled<2>(T(0));
  Rate<T, 2> rate;
  const Vector<T, 2> q = part<0, 2>(state);
  const Vector<T, 2> p = part<2, 2>(state);
  EXPECT_EQ(system.rate(T(0), q, p, w, rate), RateStatus::kOk);
  EXPECT_EQ(rate.q_dot, w) << "the multipliers are the velocity";
  return w;
}

double energy(const System& system, const Vector<double, 4>& state) {
  const Pair w = velocity(system, state);
  return system.hamiltonian(0.0, part<0, 2>(state), part<2, 2>(state), w);
}

TEST(MagneticParticleTest, KernelVariablesAreTheVelocity) {
  const System system(kTrapped);
  test::Generator generator(1);
  for (const double size : {0.0, 1e-8, 1.0, 1e4}) {
    for (int sample = 0; sample < 20; ++sample) {
      const Pair x = test::random_vector<2>(generator);
      const Pair w = test::random_vector<2>(generator, size);
      const Pair expected = momentum(kTrapped, x, w);
      const Vector<double, 4> state(x[0], x[1], expected[0], expected[1]);
      // Momenta that cancel cost digits of a slow w.
      const double tolerance = 16 * kEps * std::max(1.0, norm(w));
      EXPECT_LE(distance(velocity(system, state), w), tolerance);
      Pair v = w;
      Pair p;
      EXPECT_EQ(system.admissible_momentum(0, x, v, Pair(0, 0), p), 0);
      EXPECT_EQ(v, w);
      EXPECT_LE(distance(p, expected), 16 * kEps * std::max(1.0, norm(p)));
      const double square = dot(w, w);
      const double kinetic = square * (0.5 + 0.375 * square / 4) * 1.3;
      const double total = kinetic + 0.2 * dot(x, x);
      EXPECT_NEAR(energy(system, state), total, 32 * kEps * std::max(1.0, total));
    }
  }
}

// Without a trap, against the circle; also without a field and at rest.
TEST(MagneticParticleTest, GyrationInClosedForm) {
  constexpr double kTime = 7;
  const auto tableau = gauss_tableau<double>(8);
  for (const double field : {0.7, -3.0, 1e-9, 0.0}) {
    for (const Pair& w : {Pair(0.5, -1.2), Pair(4, 3), Pair(0, 0)}) {
      MagneticParticle scene = kFree;
      scene.field = field;
      const System system(scene);
      const Pair x(0.3, -0.2);
      auto state = make_state<double, 2>(x, momentum(scene, x, w));
      RungeKutta<System> method(system, tableau);
      ASSERT_TRUE(flow(method, StepPlan::equal(0, kTime, 40), state).completed());
      const Vector<double, 4> exact = scene.gyration(x, w, kTime);
      const Pair place = part<0, 2>(state.value);
      // Round-off of the steps and of the phase, up to 20 here.
      const double tolerance = 100 * kEps * std::max(1.0, norm(exact));
      EXPECT_LE(distance(place, part<0, 2>(exact)), tolerance) << field;
      EXPECT_LE(distance(velocity(system, state.value), part<2, 2>(exact)), tolerance) << field;
    }
  }
  // A full turn takes longer the faster it is, and comes back.
  const Pair fast(3, 0);
  const double turn = 2 * std::acos(-1.0) * kFree.inertia(fast) / kFree.field;
  EXPECT_LE(distance(kFree.gyration({1, 2}, fast, turn), Vector<double, 4>(1, 2, 3, 0)), 1e-13);
  EXPECT_EQ(kFree.inertia(fast), 1.3 * (1 + 9.0 / 8));
}

// Order 2s by slope, the kernel variables nonlinear.
TEST(MagneticParticleTest, OrderOfTheGaussMethods) {
  const System system(kFree);
  const Pair x(0.3, -0.2);
  const Pair w(1.5, -2.2);
  constexpr double kTime = 6;
  const Vector<double, 4> exact = kFree.gyration(x, w, kTime);
  for (const int stages : {1, 2, 3}) {
    const auto tableau = gauss_tableau<double>(stages);
    std::vector<double> steps;
    std::vector<double> errors;
    for (const long count : {6, 9, 12, 18, 24}) {
      RungeKutta<System> method(system, tableau);
      auto state = make_state<double, 2>(x, momentum(kFree, x, w));
      ASSERT_TRUE(flow(method, StepPlan::equal(0, kTime, count), state).completed());
      steps.push_back(kTime / static_cast<double>(count));
      errors.push_back(distance(part<0, 2>(state.value), part<0, 2>(exact)));
    }
    const auto fit = test::fit_order(steps, errors, 1e3 * kEps, 1);
    EXPECT_GE(fit.points, 4);
    EXPECT_GT(fit.correlation, 0.99);
    EXPECT_NEAR(fit.slope, 2 * stages, 0.15);
  }
}

// The gauge that the scene names against the coordinates of the Schur form in a random basis: one
// vector field.
TEST(MagneticParticleTest, DarbouxCoordinatesDoNotMatter) {
  using Plain = test::InBasis<MagneticParticle>;  // has no darboux_basis()
  static_assert(HasDarbouxBasis<MagneticParticle> && !HasDarbouxBasis<Plain>);
  const System system(kTrapped);
  const Plain scene = test::in_random_basis(kTrapped, 4);
  const GeneralizedHamiltonian<Plain> plain(scene);
  // J z' of a system at z: what y' adds to z' is in the kernel of J.
  const auto moved = [](const auto& of, const Vector<double, 6>& z) {
    const auto point = of.to_darboux(z);
    Pair y(0, 0);
    Rate<double, 2> rate;
    EXPECT_EQ(of.rate(0.0, point.q, point.p, y, rate), RateStatus::kOk);
    const Pair unknown(0, 0);
    const Vector<double, 6> z_dot = of.from_darboux(rate.q_dot, rate.p_dot, unknown);
    return product(of.scene().structure_matrix(), z_dot);
  };
  test::Generator generator(4);
  for (int sample = 0; sample < 20; ++sample) {
    const auto z = test::random_vector<6>(generator, 2);
    // A covector: that of z becomes A' times it.
    const Vector<double, 6> expected = transposed_times(scene.basis, moved(system, z));
    const double tolerance = 10 * std::pow(scene.condition(), 2) * kEps;
    EXPECT_LE(distance(moved(plain, scene.from_original(z)), expected), tolerance);
  }
}

// Prop. 3 and 4 in any basis: J (z1 - z0) = h grad H(midpoint), solved for all of z at once, keeps
// dz ^ J dz for every z0, and is the midpoint rule on (q, p) with the exact y at its stage.
TEST(MagneticParticleTest, MidpointRuleInAnyBasis) {
  using Plain = test::InBasis<MagneticParticle>;
  constexpr double kStep = 0.1;
  const Plain scene = test::in_random_basis(kTrapped, 8);
  const GeneralizedHamiltonian<Plain> system(scene);
  const Matrix<double, 6, 6> j = scene.structure_matrix();
  test::Generator generator(8);
  for (int sample = 0; sample < 5; ++sample) {
    const Vector<double, 6> z = scene.from_original(test::random_vector<6>(generator));
    const test::NaiveMidpoint<Plain> step(scene, kStep, z);
    // The linear systems have a condition of about cond(A)^2.
    const double tolerance = 10 * std::pow(scene.condition(), 2) * kEps;
    EXPECT_LE(step.residual, tolerance);
    const Matrix<double, 6, 6> form = transposed_times(step.tangent, product(j, step.tangent));
    EXPECT_LE(test::largest_change(form, j), tolerance * std::pow(norm(step.tangent), 2));

    const auto stage = system.to_darboux(step.middle);
    Vector<double, 6> step_of_z = step.end;
    subtract_from(step_of_z, z);
    const auto change = system.to_darboux(step_of_z);
    Pair y = stage.y;
    Rate<double, 2> rate;
    ASSERT_EQ(system.rate(0.0, stage.q, stage.p, y, rate), RateStatus::kOk);
    EXPECT_LE(distance(stage.y, y), tolerance);
    EXPECT_LE((distance<double, 2, 1>(change.q, kStep * rate.q_dot)), tolerance);
    EXPECT_LE((distance<double, 2, 1>(change.p, kStep * rate.p_dot)), tolerance);
  }
}

// x p_y - y p_x is quadratic, so a Gauss method keeps it to round-off; H it keeps nearly.
TEST(MagneticParticleTest, Invariants) {
  const System system(kTrapped);
  const auto tableau = gauss_tableau<double>(3);
  const Pair x(1, 0.5);
  auto state = make_state<double, 2>(x, momentum(kTrapped, x, {1.5, -2.2}));
  const auto turning = [](const Vector<double, 4>& s) { return s[0] * s[3] - s[1] * s[2]; };
  const double h0 = energy(system, state.value);
  const double l0 = turning(state.value);
  constexpr long kSteps = 2000;
  double early = 0;
  double late = 0;
  RungeKutta<System> method(system, tableau);
  const auto report =
      flow(method, StepPlan::equal(0, 0.2 * kSteps, kSteps), state, [&](long i, auto&, auto& z) {
        double& largest = i < kSteps / 2 ? early : late;
        largest = std::max(largest, std::abs(energy(system, z.value) - h0));
        return true;
      });
  ASSERT_TRUE(report.completed()) << report.reason();
  EXPECT_NEAR(turning(state.value), l0, 100 * kEps * std::abs(l0));
  EXPECT_GT(early, 1e-12) << "an error of the method, not of round-off";
  EXPECT_LT(late, 1.1 * early) << "bounded";
}

// Back in time with y mirrored: a magnetic field spoils the reversal p -> -p alone.
TEST(MagneticParticleTest, Reversal) {
  const System system(kTrapped);
  const auto tableau = gauss_tableau<double>(2);
  const Pair x(1, 0.5);
  const auto start = make_state<double, 2>(x, momentum(kTrapped, x, {1.5, -2.2}));
  const auto after = [&](State<double, 2> z) {
    RungeKutta<System> method(system, tableau);
    EXPECT_TRUE(flow(method, StepPlan::equal(0, 4, 20), z).completed());
    return z;
  };
  const auto reversed = [](State<double, 2> z) {
    for (const int i : {1, 2}) {  // y, p_x
      z.value[i] *= -1;
      z.compensation[i] *= -1;
    }
    return z;
  };
  const auto end = reversed(after(reversed(after(start))));
  EXPECT_LE(distance(end.value, start.value), 200 * kEps);
  const auto flipped = test::flipped<double, 2>(after(test::flipped<double, 2>(after(start))));
  EXPECT_GT(distance(flipped.value, start.value), 0.1);
}

// A wider scalar is used to its end.
TEST(MagneticParticleTest, LongDouble) {
  using Wide = long double;
  const System system(kTrapped);
  const Vector<Wide, 4> state(Wide(1) / 3, Wide(2) / 7, Wide(3) / 11, Wide(4) / 13);
  const Vector<Wide, 2> w = velocity(system, state);
  const Wide inertia = Wide(kTrapped.mass) * (1 + dot(w, w) / 8);
  const Wide half_field = Wide(kTrapped.field) / 2;
  const Wide unit = std::numeric_limits<Wide>::epsilon();
  EXPECT_LE(std::abs(inertia * w[0] - half_field * state[1] - state[2]), 8 * unit);
  EXPECT_LE(std::abs(inertia * w[1] + half_field * state[0] - state[3]), 8 * unit);
}

TEST(MagneticParticleTest, ParametersAreChecked) {
  EXPECT_NO_THROW(validate(MagneticParticle{1, -5, 1, 0}));
  EXPECT_THROW(validate(MagneticParticle{0, 1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(validate(MagneticParticle{1, std::nan(""), 1, 1}), std::invalid_argument);
  EXPECT_THROW(validate(MagneticParticle{1, 1, 0, 1}), std::invalid_argument);
  EXPECT_THROW(validate(MagneticParticle{1, 1, 1, -1}), std::invalid_argument);
  const SceneInfo info = describe_scene(MagneticParticle{});
  EXPECT_EQ(info.configuration.size(), 2U);
  EXPECT_EQ(info.kind, "generalized Hamiltonian");
}

}  // namespace
}  // namespace carnot::magnetic_particle_test
