// Derivatives of H side by side against differences, and the family that scales the drift.
#include "carnot/shooting/problem/hamiltonian_terms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "catalogue/scene_choice.h"
#include "shooting/drift_problems.h"

namespace carnot::internal::hamiltonian_terms_test {
namespace {

using Order = HamiltonianTerms::Order;

// One scene of each kind: linear and nonlinear controls, a Lagrangian that depends on time,
// nonlinear constraints, a structure matrix, and velocity constraints.
class Kinds : public ::testing::TestWithParam<std::string> {};

Dynamics of_text(const std::string& name) {
  return make_dynamics(load_scene(CARNOT_SOURCE_DIR "/lib/carnot/scenes/" + name + ".scene"));
}
Dynamics of(const std::string& name) { return apps::find_scene(name).make({}, "gauss16"); }

TEST_P(Kinds, DerivativesAreThoseOfH) {
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-8;  // of central differences with this step
  const Dynamics dynamics = of(GetParam());
  const int n = dynamics.dof;
  for (const double drift : {1.0, 0.4}) {
    HamiltonianTerms terms(dynamics, drift);
    HamiltonianTerms aside(dynamics, drift);
    std::vector<double> q(n), p(n);
    for (int j = 0; j < n; ++j) {
      q[j] = 0.3 + 0.1 * j;
      p[j] = 0.7 - 0.2 * j;
    }
    constexpr double kTime = 0.2;
    terms.set(0, kTime, q.data(), p.data());
    ASSERT_TRUE(terms.evaluate(1, Order::kSecond));
    for (int k = 0; k < 2 * n; ++k) {
      double& moved = k < n ? q[k] : p[k - n];
      const double at = moved;
      for (const int side : {0, 1}) {
        moved = at + (side == 0 ? -kStep : kStep);
        aside.set(side, kTime, q.data(), p.data());
      }
      moved = at;
      ASSERT_TRUE(aside.evaluate(2, Order::kFirst));
      const auto slope = [&](const auto& of_point) {
        return (of_point(1) - of_point(0)) / (2 * kStep);
      };
      const double by = k < n ? terms.by_q(0, k) : terms.by_p(0, k - n);
      EXPECT_NEAR(slope([&](int l) { return aside.value(l); }), by, kTolerance) << k;
      for (int j = 0; j < n; ++j) {
        const double of_q = k < n ? terms.qq(0, j, k) : terms.qp(0, j, k - n);
        const double of_p = k < n ? terms.qp(0, k, j) : terms.pp(0, j, k - n);
        EXPECT_NEAR(slope([&](int l) { return aside.by_q(l, j); }), of_q, kTolerance) << j << k;
        EXPECT_NEAR(slope([&](int l) { return aside.by_p(l, j); }), of_p, kTolerance) << j << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         Kinds,
                         ::testing::Values("double-integrator",
                                           "boat",
                                           "kapitza-pendulum",
                                           "relativistic-particle",
                                           "magnetic-particle",
                                           "vehicle"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           for (char& c : name) c = c == '-' ? '_' : c;
                           return name;
                         });

TEST(HamiltonianTerms, ScalesTheDriftAndNothingElse) {
  const Dynamics dynamics = test::literature("pendulum-swing-up");
  constexpr double kDrift = 0.3;
  HamiltonianTerms scaled(dynamics, kDrift);
  const std::vector<double> q{0.4, 0.9};
  const std::vector<double> p{0.2, -0.7};
  scaled.set(0, 0, q.data(), p.data());
  ASSERT_TRUE(scaled.evaluate(1, Order::kSecond));
  // H = d (p_theta omega - p_omega sin theta) + p_omega^2 / 2.
  constexpr double kRoundOff = 1e-15;
  EXPECT_NEAR(scaled.by_p(0, 0), kDrift * q[1], kRoundOff);
  EXPECT_NEAR(scaled.by_p(0, 1), -kDrift * std::sin(q[0]) + p[1], kRoundOff);
  EXPECT_NEAR(scaled.pp(0, 1, 1), 1, kRoundOff);
  EXPECT_NEAR(scaled.qq(0, 0, 0), kDrift * p[1] * std::sin(q[0]), kRoundOff);
}

// |N'p|^2 / 2 with the normal N of the sphere, whatever the drift.
TEST(HamiltonianTerms, FixesTheGaugeOfMomenta) {
  const Dynamics sphere = of_text("spherical-pendulum");
  const std::vector<double> q{0, 0, -1};
  const std::vector<double> p{0.3, -0.2, 0.7};
  for (const double drift : {1.0, 0.4}) {
    HamiltonianTerms terms(sphere, drift);
    terms.set(0, 0, q.data(), p.data());
    ASSERT_TRUE(terms.evaluate(1, Order::kSecond));
    const double value = terms.value(0);
    const double along = terms.by_p(0, 2);
    const double second = terms.pp(0, 2, 2);
    terms.fix_gauge(0, q.data());
    constexpr double kRoundOff = 1e-14;
    EXPECT_NEAR(terms.value(0) - value, 0.5 * p[2] * p[2], kRoundOff);
    EXPECT_NEAR(terms.by_p(0, 2) - along, p[2], kRoundOff);
    EXPECT_NEAR(terms.pp(0, 2, 2) - second, 1, kRoundOff);
  }
}

TEST(HamiltonianTerms, SaysWhereHDoesNotExist) {
  // Without momentum the boat has no heading.
  const Dynamics dynamics = of("boat");
  HamiltonianTerms terms(dynamics);
  const std::vector<double> q{0, 0};
  const std::vector<double> rest{0, 0};
  const std::vector<double> p{1, 0.5};
  terms.set(0, 0, q.data(), rest.data());
  EXPECT_FALSE(terms.evaluate(1, Order::kSecond));
  EXPECT_TRUE(std::isnan(terms.value(0)));
  EXPECT_TRUE(std::isnan(terms.pp(0, 1, 1)));
  terms.set(0, 0, q.data(), p.data());
  EXPECT_TRUE(terms.evaluate(1, Order::kSecond));
}

}  // namespace
}  // namespace carnot::internal::hamiltonian_terms_test
