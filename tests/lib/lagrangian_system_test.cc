// Lagrangian scenes against the same scenes written with M(q) and G(q): point by point, and along
// the flow.
#include "carnot/system/lagrangian_system.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "carnot/flow/flow.h"
#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/heisenberg_group.h"
#include "carnot/step/gauss.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/distance.h"
#include "testing/lagrangian_forms.h"
#include "testing/random_points.h"
#include "testing/scene_wrappers.h"

namespace carnot::lagrangian_system_test {
namespace {

using test::largest_change;
using test::norm;

constexpr double kEps = epsilon<double>();

// The two forms of one scene. The multiplier route of VelocityConstraints has y = (v, lambda) too.
struct VehiclePair {
  static constexpr scenes::Vehicle kScene{0.7, 0.4, 1.3};
  using Lagrangian = test::LagrangianVehicle;
  using Linear = test::WithoutFrame<scenes::Vehicle>;
  static Lagrangian lagrangian() { return {kScene}; }
  static Linear linear() { return {kScene}; }
};
struct HeisenbergPair {
  using Lagrangian = test::LagrangianHeisenberg;
  using Linear = test::WithoutFrame<scenes::Heisenberg>;
  static Lagrangian lagrangian() { return {}; }
  static Linear linear() { return {}; }
};
static_assert(LagrangianScene<test::LagrangianVehicle> && !LagrangianScene<scenes::Vehicle>);
static_assert(!VelocityConstrainedScene<test::LagrangianVehicle>);
static_assert(IndexOneSystem<LagrangianSystem<test::LagrangianVehicle>>);
static_assert(HasRegularity<LagrangianSystem<test::LagrangianVehicle>>);
static_assert(HasBranches<LagrangianSystem<test::LagrangianVehicle>>);
static_assert(LagrangianSystem<test::LagrangianVehicle>::kAutonomous);

template <class Pair>
class LagrangianSystemTest : public ::testing::Test {
 protected:
  using Lagrangian = LagrangianSystem<typename Pair::Lagrangian>;
  using Linear = VelocityConstraints<typename Pair::Linear>;
  static constexpr int n = Lagrangian::kDof;
  static constexpr int k = Lagrangian::kMultipliers;
  static constexpr int m = Lagrangian::kAlgebraic;
  static_assert(m == Linear::kAlgebraic);
  using Q = Vector<double, n>;
  using Lambda = Vector<double, k>;

  const Lagrangian lagrangian_{Pair::lagrangian()};
  const Linear linear_{Pair::linear()};

  template <class Check>
  void at_random_points(const Check& check) const {
    test::Generator generator(3);
    for (int sample = 0; sample < 20; ++sample) {
      const Q q = test::random_vector<n>(generator, 2);
      const Q p = test::random_vector<n>(generator, 2);
      check(q, p, test::random_vector<k>(generator, 2));
    }
  }
};

using Pairs = ::testing::Types<VehiclePair, HeisenbergPair>;
struct PairNames {
  template <class Pair>
  static std::string GetName(int i) {
    return std::array{"vehicle", "heisenberg"}[static_cast<std::size_t>(i)];
  }
};
TYPED_TEST_SUITE(LagrangianSystemTest, Pairs, PairNames);

// Round-off of two linear systems with a condition of up to 100 at these points.
constexpr double kRoundOff = 2000 * kEps;

TYPED_TEST(LagrangianSystemTest, RateIsThatOfTheLinearForm) {
  this->at_random_points([&](const auto& q, const auto& p, const auto& lambda) {
    constexpr int kDof = TestFixture::n;
    Vector<double, TestFixture::m> y[2] = {filled<TestFixture::m>(0.0),
                                           filled<TestFixture::m>(0.0)};
    Rate<double, kDof> rate[2];
    ASSERT_EQ(this->lagrangian_.rate(0.0, q, p, y[0], rate[0]), RateStatus::kOk);
    ASSERT_EQ(this->linear_.rate(0.0, q, p, y[1], rate[1]), RateStatus::kOk);
    EXPECT_LE(largest_change(rate[0].q_dot, rate[1].q_dot), kRoundOff);
    EXPECT_LE(largest_change(rate[0].p_dot, rate[1].p_dot), kRoundOff);
    EXPECT_LE(largest_change(y[0], y[1]), kRoundOff);
    EXPECT_NEAR(this->lagrangian_.hamiltonian(0.0, q, p, y[0]),
                this->linear_.hamiltonian(0.0, q, p, y[1]),
                kRoundOff);
    EXPECT_NEAR(this->lagrangian_.lagrangian(0.0, q, p), this->linear_.lagrangian(q, p), kRoundOff);
    EXPECT_LE(largest_change(this->lagrangian_.constraint(q, p), this->linear_.constraint(q, p)),
              kRoundOff);
    auto multipliers = lambda;
    ASSERT_EQ(this->lagrangian_.multipliers(0.0, q, p, y[0], multipliers), RateStatus::kOk);
    EXPECT_EQ(largest_change(multipliers, part<kDof, TestFixture::k>(y[0])), 0);
  });
}

// v is projected, p = dL/dv - G' lambda is made of it, and rate() finds (v, lambda) again.
TYPED_TEST(LagrangianSystemTest, MomentumIsThatOfTheLinearForm) {
  this->at_random_points([&](const auto& q, const auto& velocity, const auto& lambda) {
    auto v = velocity;
    auto w = velocity;
    auto p = velocity;
    auto linear_p = velocity;
    const double violated = this->lagrangian_.admissible_momentum(0.0, q, v, lambda, p);
    EXPECT_NEAR(
        violated, this->linear_.admissible_momentum(0.0, q, w, lambda, linear_p), kRoundOff);
    EXPECT_LE(largest_change(v, w), kRoundOff);
    EXPECT_LE(largest_change(p, linear_p), kRoundOff);
    EXPECT_LE(norm(this->lagrangian_.constraint(q, v)), kRoundOff);
    EXPECT_TRUE(std::isnan(this->lagrangian_.speed(q, v)));

    Vector<double, TestFixture::m> y = filled<TestFixture::m>(0.0);
    Rate<double, TestFixture::n> rate;
    ASSERT_EQ(this->lagrangian_.rate(0.0, q, p, y, rate), RateStatus::kOk);
    EXPECT_LE(largest_change(rate.q_dot, v), kRoundOff);
    EXPECT_LE(largest_change(part<TestFixture::n, TestFixture::k>(y), lambda), kRoundOff);
    // The only branch is the nearest to any guess.
    Vector<double, TestFixture::m> nearest;
    auto guess = lambda;
    add_to(guess, lambda);
    ASSERT_EQ(this->lagrangian_.branch(0.0, q, p, guess, nearest), RateStatus::kOk);
    EXPECT_LE(largest_change(nearest, y), kRoundOff);
    const Regularity regularity = this->lagrangian_.regularity(0.0, q, p, y);
    EXPECT_NE(regularity.determinant, 0);
    EXPECT_LE(regularity.condition, 1e3);
  });
}

TYPED_TEST(LagrangianSystemTest, FlowIsThatOfTheLinearForm) {
  constexpr double kTolerance = 1e-13;  // what the round-off of forty steps leaves
  constexpr int kDof = TestFixture::n;
  test::Generator generator(4);
  for (int sample = 0; sample < 3; ++sample) {
    const auto q = test::random_vector<kDof>(generator);
    const auto p = test::random_vector<kDof>(generator);
    auto z = make_state<double, kDof>(q, p);
    auto linear_z = z;
    Gauss<typename TestFixture::Lagrangian, 4> method(this->lagrangian_);
    Gauss<typename TestFixture::Linear, 4> linear_method(this->linear_);
    double violated = 0;
    const FlowReport report =
        flow(method, StepPlan::equal(0, 2, 40), z, [&](long, const auto& step, const auto&) {
          for (int i = 0; i < 4; ++i) {
            Vector<double, kDof> stage;
            for (int j = 0; j < kDof; ++j) stage[j] = step.stages()(j, i);
            const Vector<double, kDof> v = part<0, kDof>(step.algebraic(i));
            violated = maximum(violated, norm(this->lagrangian_.constraint(stage, v)));
          }
          return true;
        });
    ASSERT_TRUE(report.completed()) << report.reason();
    ASSERT_TRUE(flow(linear_method, StepPlan::equal(0, 2, 40), linear_z).completed());
    EXPECT_LE(largest_change(z.value, linear_z.value), kTolerance);
    EXPECT_LE(violated, kRoundOff);
  }
}

// L_vv is singular, but not on the admissible velocities: still of index 1.
TEST(LagrangianHeisenbergGroupTest, LagrangianNeedNotContainEveryVelocity) {
  const LagrangianSystem<test::LagrangianHeisenbergGroup> lagrangian{{}};
  const VelocityConstraints<scenes::HeisenbergGroup> linear{{}};
  test::Generator generator(5);
  for (int sample = 0; sample < 20; ++sample) {
    const auto q = test::random_vector<3>(generator, 2);
    const auto p = test::random_vector<3>(generator, 2);
    Vector<double, 4> y = filled<4>(0.0);
    Vector<double, 2> u;
    Vector<double, 1> lambda;
    Rate<double, 3> rate[2];
    ASSERT_EQ(lagrangian.rate(0.0, q, p, y, rate[0]), RateStatus::kOk);
    ASSERT_EQ(linear.rate(0.0, q, p, u, rate[1]), RateStatus::kOk);
    ASSERT_EQ(linear.multipliers(0.0, q, p, u, lambda), RateStatus::kOk);
    EXPECT_LE(largest_change(rate[0].q_dot, rate[1].q_dot), kRoundOff);
    EXPECT_LE(largest_change(rate[0].p_dot, rate[1].p_dot), kRoundOff);
    EXPECT_NEAR(y[3], lambda[0], kRoundOff);
  }
}

}  // namespace
}  // namespace carnot::lagrangian_system_test
