// A constraint that is not linear in v: two multipliers for one momentum, each kept by its flow.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/scenes/appell.h"
#include "carnot/step/gauss.h"
#include "carnot/system/lagrangian_system.h"
#include "testing/order.h"

namespace carnot::lagrangian_branch_test {
namespace {

constexpr double kEps = epsilon<double>();
using System = LagrangianSystem<scenes::Appell>;
using Q = Vector<double, 3>;
using Y = Vector<double, 4>;
using Lambda = Vector<double, 1>;

const Q kMomentum(1.2, 0.5, 0.7);
// Across the momentum, so that a spring of 1 makes the slow branch nearly a circle: v stays away
// from 0 on both branches.
const Q kStart(0.6 * 0.5 / 1.3, -0.6 * 1.2 / 1.3, 0.1);

struct Branch {
  int sign;
  double lambda;
};
constexpr std::array kBranches{Branch{1, -0.15}, Branch{-1, -5.0 / 3}};

Y on_branch(const System& system, const Q& q, const Q& p, double lambda) {
  Y y = Y::Zero();
  EXPECT_EQ(system.branch(0.0, q, p, Lambda(lambda), y), RateStatus::kOk);
  return y;
}

TEST(LagrangianBranchTest, OneMomentumHasTwoMultipliers) {
  const System system{{}};
  for (const auto& [sign, lambda] : kBranches) {
    for (const double guess : {1.0, 0.9, 1.1}) {
      const Y y = on_branch(system, kStart, kMomentum, guess * lambda);
      EXPECT_NEAR(y[3], lambda, 32 * kEps);  // conditions of about 20 and 300
      EXPECT_NEAR(y[3], system.scene().multiplier(kMomentum, sign), 32 * kEps);
      EXPECT_EQ(std::copysign(1, y[2]), sign);
      EXPECT_LE(system.constraint(kStart, Q(y.head<3>())).norm(), 4 * kEps);
      const Q back = system.momentum(0.0, kStart, Q(y.head<3>()), Lambda(y[3]));
      EXPECT_LE((back - kMomentum).norm(), 8 * kEps);
      const Regularity regularity = system.regularity(0.0, kStart, kMomentum, y);
      EXPECT_NE(regularity.determinant, 0);
      EXPECT_LE(regularity.condition, 1e3);
    }
  }
}

TEST(LagrangianBranchTest, TheNearestOfTheTwoIsTaken) {
  const System system{{}};
  for (const double guess : {-100.0, -2.0, -1.2, -1.0, -0.8, 0.0, 0.5, 3.0, 100.0}) {
    const bool first = std::abs(guess + 0.15) < std::abs(guess + 5.0 / 3);
    EXPECT_NEAR(
        on_branch(system, kStart, kMomentum, guess)[3], first ? -0.15 : -5.0 / 3, 32 * kEps);
  }
}

// Cold, it is the velocity guess of the scene that decides; warm, y does.
TEST(LagrangianBranchTest, RateStaysOnTheBranchOfItsWarmStart) {
  const System system{{}};
  Rate<double, 3> rate;
  Y cold = Y::Zero();
  ASSERT_EQ(system.rate(0.0, kStart, kMomentum, cold, rate), RateStatus::kOk);
  EXPECT_NEAR(cold[3], -0.15, 32 * kEps);
  for (const auto& [sign, lambda] : kBranches) {
    for (const double far : {1e-3, 0.03, 0.1}) {
      Y y = (1 + far) * on_branch(system, kStart, kMomentum, lambda);
      ASSERT_EQ(system.rate(0.0, kStart, kMomentum, y, rate), RateStatus::kOk);
      EXPECT_NEAR(y[3], lambda, 32 * kEps);
      EXPECT_EQ(std::copysign(1, rate.q_dot[2]), sign);
    }
  }
}

// ----- flows

// The scene in a spring, or falling, from kStart on one branch. Checks every step for the branch
// and the constraint, and the invariants that hold in both.
template <int s>
State<double, 3> checked_flow(const System& system,
                              const Branch& branch,
                              double duration,
                              long steps) {
  const scenes::Appell& scene = system.scene();
  // A rounding error per step, and the condition of lambda, below 1e3 here.
  const double tolerance = 1e3 * kEps;
  // Stages end at round-off, and their errors add up like a random walk.
  const double drift = 32 * kEps * std::sqrt(static_cast<double>(steps));
  Gauss<System, s> method(system);
  method.start_on(on_branch(system, kStart, kMomentum, branch.lambda));
  auto z = make_state<double, 3>(kStart, kMomentum);
  const auto energy = [&](const auto& state, const Y& y) {
    return system.hamiltonian(
        0.0, Q(state.value.template head<3>()), Q(state.value.template tail<3>()), y);
  };
  const double h = energy(z, method.branch());
  const auto turn = [](const auto& state) {
    return state.value[0] * state.value[4] - state.value[1] * state.value[3];
  };
  const double momentum = turn(z);
  double wrong_branch = 0;
  double violated = 0;
  double energy_drift = 0;
  const auto report = flow(
      method,
      StepPlan::equal(0, duration, steps),
      z,
      [&](long, const auto& step, const auto& state) {
        for (int i = 0; i < s; ++i) {
          const Q p = step.stages().col(i).template tail<3>();
          const Y y = step.algebraic(i);
          const double lambda = scene.multiplier(p, branch.sign);
          wrong_branch = std::max(wrong_branch, std::abs(y[3] - lambda) / (1 + std::abs(lambda)));
          violated = std::max(violated, system.constraint(Q(), Q(y.head<3>())).norm());
        }
        Y y = step.branch();
        Rate<double, 3> rate;
        EXPECT_EQ(
            system.rate(
                0.0, Q(state.value.template head<3>()), Q(state.value.template tail<3>()), y, rate),
            RateStatus::kOk);
        energy_drift = std::max(energy_drift, std::abs(energy(state, y) - h));
        return true;
      });
  EXPECT_TRUE(report.completed()) << report.reason() << " at " << report.time_reached;
  EXPECT_LE(wrong_branch, tolerance);
  EXPECT_LE(violated, tolerance);
  EXPECT_LE(energy_drift, drift);
  EXPECT_NEAR(turn(z), momentum, drift);
  return z;
}

TEST(LagrangianBranchTest, FallingBodyFollowsTheClosedForm) {
  constexpr double kDuration = 60;
  scenes::Appell scene;
  scene.gravity = 0.02;
  const System system(scene);
  for (const Branch& branch : kBranches) {
    const auto z = checked_flow<2>(system, branch, kDuration, 300);
    const Vector<double, 6> exact = scene.closed_form(kStart, kMomentum, branch.sign, kDuration);
    EXPECT_LE((z.value - exact).norm(), 16 * kEps * exact.norm());
    EXPECT_EQ(z.value.segment<2>(3), kMomentum.head<2>());
  }
}

TEST(LagrangianBranchTest, SpringKeepsTheBranchForManyTurns) {
  scenes::Appell scene;
  scene.stiffness = 1;
  const System system(scene);
  for (const Branch& branch : kBranches) {
    const auto z = checked_flow<4>(system, branch, 200, 2000);
    EXPECT_EQ(z.value[5], kMomentum[2]);
  }
}

// A falling body comes to rest where c P + p_z = 0: v = 0, lambda infinite, no index 1. The run
// ends before, with a reason and the last good state.
TEST(LagrangianBranchTest, RunEndsWhereTheBranchDoes) {
  constexpr double kStep = 0.09;
  scenes::Appell scene;
  scene.gravity = 1;
  const System system(scene);
  const double rest = 1.3 + 0.7;
  Gauss<System, 2> method(system);
  method.start_on(on_branch(system, kStart, kMomentum, -0.15));
  auto z = make_state<double, 3>(kStart, kMomentum);
  const FlowReport report = flow(method, StepPlan::of_length(0, 2 * rest, kStep), z);
  EXPECT_FALSE(report.completed());
  EXPECT_TRUE(report.last.rate == RateStatus::kNoSolution ||
              report.last.rate == RateStatus::kNotIndexOne);
  EXPECT_FALSE(report.reason().empty());
  EXPECT_LE(report.time_reached, rest);
  EXPECT_GE(report.time_reached, rest - 2 * kStep);
  const Vector<double, 6> exact = scene.closed_form(kStart, kMomentum, 1, report.time_reached);
  EXPECT_LE((z.value - exact).norm(), 1e3 * kEps);  // lambda reaches a hundred
}

// ----- laws of the method on a constraint that is not linear

scenes::Appell in_a_spring() {
  scenes::Appell scene;
  scene.c = 1.1;
  scene.gravity = 0.1;
  scene.stiffness = 1;
  return scene;
}

TEST(LagrangianBranchTest, OrderOfAGaussMethod) {
  constexpr double kDuration = 2;
  const System system(in_a_spring());
  for (const Branch& branch : kBranches) {
    const Y y = on_branch(system, kStart, kMomentum, branch.lambda);
    const auto end = [&](auto method, long steps) {
      method.start_on(y);
      auto z = make_state<double, 3>(kStart, kMomentum);
      EXPECT_TRUE(flow(method, StepPlan::equal(0, kDuration, steps), z).completed());
      return z.value;
    };
    const Vector<double, 6> reference = end(Gauss<System, 4>(system), 100);
    std::vector<double> steps;
    std::vector<double> errors;
    for (const long count : {10L, 15L, 22L, 33L, 50L}) {
      steps.push_back(kDuration / static_cast<double>(count));
      errors.push_back((end(Gauss<System, 2>(system), count) - reference).norm());
    }
    const LineFit fit = test::fit_order(steps, errors, 1e-12, 1e-3);
    EXPECT_GE(fit.points, 4);
    EXPECT_GT(fit.correlation, 0.99);
    EXPECT_NEAR(fit.slope, 4, 0.15);
  }
}

TEST(LagrangianBranchTest, TangentIsSymplecticAndThatOfTheFlow) {
  using Square = Matrix<double, 6, 6>;
  constexpr double kStep = 1e-3;
  constexpr double kDifferences = 1e-8;  // kStep^4, eps/kStep, times high derivatives up to 1e3
  constexpr double kDefect = 1e-14;      // about 50 eps, per |M|^2
  const System system(in_a_spring());
  for (const Branch& branch : kBranches) {
    Gauss<System, 2> method(system);
    const auto end = [&](const Vector<double, 6>& start, Compensated<Square>& m) {
      // The same branch of the neighbour.
      method.start_on(on_branch(system, start.head<3>(), start.tail<3>(), branch.lambda));
      State<double, 3> z{start, Vector<double, 6>::Zero()};
      const auto go_on = [](long, const auto&, const auto&) { return true; };
      EXPECT_TRUE(tangent_flow(method, StepPlan::equal(0, 1, 10), z, m, go_on).completed());
      return z.value;
    };
    Vector<double, 6> start;
    start << kStart, kMomentum;
    Compensated<Square> m{Square::Identity(), Square::Zero()};
    Compensated<Square> unused = m;
    end(start, m);
    EXPECT_LE(symplecticity_defect(m.value), kDefect * std::max(1.0, m.value.squaredNorm()));
    for (int i = 0; i < 6; ++i) {
      const Vector<double, 6> d = kStep * Vector<double, 6>::Unit(i);
      const Vector<double, 6> near = end(start + d, unused) - end(start - d, unused);
      const Vector<double, 6> far = end(start + 2 * d, unused) - end(start - 2 * d, unused);
      EXPECT_LE(((8 * near - far) / (12 * kStep) - m.value.col(i)).norm(), kDifferences);
    }
  }
}

}  // namespace
}  // namespace carnot::lagrangian_branch_test
