#include "carnot/system/velocity_constraints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "testing/distance.h"
#include "testing/random_points.h"
#include "testing/scene_list.h"
#include "testing/scene_wrappers.h"

namespace carnot::velocity_constraints_test {
namespace {

using test::Generator;
using test::largest_change;
using test::random_vector;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Points in [-2, 2]^n, momenta up to 2; two solves with condition numbers up to 100.
constexpr double kRoundOff = 1000 * kEps;
constexpr int kSamples = 100;

// Rate, y and multipliers of a system at a point where all must be well.
template <class System>
struct Solved {
  static constexpr int n = System::kDof;
  Vector<double, System::kAlgebraic> y = filled<System::kAlgebraic>(0.0);
  Rate<double, n> rate;
  Vector<double, System::kMultipliers> lambda;

  Solved(const System& system, const Vector<double, n>& q, const Vector<double, n>& p) {
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    EXPECT_EQ(system.multipliers(q, p, rate.q_dot, lambda), RateStatus::kOk);
  }
};

template <class Scene>
class VelocityConstraintsTest : public ::testing::Test {
 protected:
  static constexpr int n = Scene::kDof;
  static constexpr int k = Scene::kMultipliers;
  using Q = Vector<double, n>;
  using Framed = VelocityConstraints<Scene>;
  using Plain = VelocityConstraints<test::WithoutFrame<Scene>>;
  using ByJets = VelocityConstraints<test::WithoutHandDerivatives<Scene>>;

  Framed framed_{test::uneven<Scene>()};
  Plain plain_{{test::uneven<Scene>()}};
  ByJets by_jets_{{{test::uneven<Scene>()}}};

  // The hard points by hand, then random ones.
  template <class Check>
  void at_all_points(const Check& check) const {
    Generator generator(11);
    check(filled<n>(0.0), filled<n>(1.0));
    check(filled<n>(0.0), filled<n>(0.0));
    check(filled<n>(1e-8), filled<n>(-1e-8));
    for (int i = 0; i < kSamples; ++i) {
      const Q q = random_vector<n>(generator, 2);
      check(q, random_vector<n>(generator, 2));
    }
  }
};
TYPED_TEST_SUITE(VelocityConstraintsTest, test::Scenes, test::SceneNames);

TYPED_TEST(VelocityConstraintsTest, WrappersHideWhatTheySay) {
  using Bare = test::WithoutFrame<TypeParam>;
  using JetsOnly = test::WithoutHandDerivatives<TypeParam>;
  static_assert(HasFrame<TypeParam> && HasFrameGradient<TypeParam>);
  static_assert(!HasFrame<Bare> && HasFrame<JetsOnly>);
  static_assert(!HasFrameGradient<JetsOnly> && !HasFrameMass<JetsOnly>);
  static_assert(HasPotential<Bare> == HasPotential<TypeParam>);
  static_assert(HasPotential<JetsOnly> == HasPotential<TypeParam>);
  static_assert(IndexOneSystem<VelocityConstraints<TypeParam>>);
  static_assert(IndexOneSystem<VelocityConstraints<Bare>>);
}

// A scene that says that its M is constant gives the same one everywhere, and all others do not.
TYPED_TEST(VelocityConstraintsTest, SaysWhetherTheMassIsConstant) {
  bool constant = true;
  this->at_all_points([&](const auto& q, const auto& /*p*/) {
    const auto mass = this->framed_.scene().mass(seeded(q));
    for (int i = 0; i < this->n; ++i) {
      for (int j = 0; j < this->n; ++j) {
        for (int d = 0; d < this->n; ++d) constant = constant && mass(i, j).v[d] == 0;
      }
    }
  });
  EXPECT_EQ(constant, HasConstantMass<TypeParam>);
}

TYPED_TEST(VelocityConstraintsTest, FrameRouteAgreesWithMultiplierRoute) {
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    const Solved b(this->plain_, q, p);
    EXPECT_LE(largest_change(a.rate.q_dot, b.rate.q_dot), kRoundOff);
    EXPECT_LE(largest_change(a.rate.p_dot, b.rate.p_dot), kRoundOff);
    EXPECT_LE(largest_change(a.lambda, b.lambda), kRoundOff);
    EXPECT_NEAR(this->framed_.hamiltonian(0.0, q, p, a.y),
                this->plain_.hamiltonian(0.0, q, p, b.y),
                kRoundOff);
  });
}

TYPED_TEST(VelocityConstraintsTest, HandDerivativesAgreeWithJets) {
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    const Solved b(this->by_jets_, q, p);
    EXPECT_LE(largest_change(a.rate.q_dot, b.rate.q_dot), kRoundOff);
    EXPECT_LE(largest_change(a.rate.p_dot, b.rate.p_dot), kRoundOff);
    EXPECT_LE(largest_change(a.y, b.y), kRoundOff);
  });
}

// The multipliers are part of y on the multiplier route, and separate output on the other.
TYPED_TEST(VelocityConstraintsTest, AlgebraicVariablesHoldVelocityAndMultipliers) {
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved b(this->plain_, q, p);
    constexpr int kDof = TypeParam::kDof;
    EXPECT_EQ(largest_change(b.rate.q_dot, part<0, kDof>(b.y)), 0);
    EXPECT_LE(largest_change(b.lambda, part<kDof, TypeParam::kMultipliers>(b.y)), kRoundOff);
  });
}

TYPED_TEST(VelocityConstraintsTest, FrameSpansTheKernel) {
  this->at_all_points([&](const auto& q, const auto&) {
    const auto& scene = this->framed_.scene();
    const auto b = scene.frame(q);
    EXPECT_LE(largest_entry(product(scene.constraints(q), b)), 8 * kEps);
    const auto gram = transposed_times(b, b);
    constexpr int kColumns = TypeParam::kDof - TypeParam::kMultipliers;
    EXPECT_TRUE((Cholesky<double, kColumns>(gram).positive()));
  });
}

TYPED_TEST(VelocityConstraintsTest, VelocityIsAdmissibleAndMomentumDecomposes) {
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    EXPECT_LE(largest_entry(this->framed_.constraint(q, a.rate.q_dot)), kRoundOff);
    EXPECT_LE(largest_change(this->framed_.momentum(q, a.rate.q_dot, a.lambda), p), kRoundOff);
  });
}

template <class Scene>
class RegularMassTest : public VelocityConstraintsTest<Scene> {};
TYPED_TEST_SUITE(RegularMassTest, test::RegularMassScenes, test::SceneNames);

// System (8) of the paper: (G M^-1 G') lambda = -G M^-1 p, where M^-1 exists.
TYPED_TEST(RegularMassTest, MultipliersSolveThePapersSystem) {
  constexpr int kDof = TypeParam::kDof;
  const Matrix<double, kDof, kDof> mass = this->framed_.scene().mass(filled<kDof>(0.0));
  Matrix<double, kDof, kDof> inverse = filled<kDof, kDof>(0.0);
  for (int i = 0; i < kDof; ++i) inverse(i, i) = 1 / mass(i, i);
  ASSERT_LE(largest_change(product(mass, inverse), identity<kDof, double>()), kRoundOff)
      << "all scenes have a diagonal M";
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    const auto g = this->framed_.scene().constraints(q);
    const auto g_inverse = product(g, inverse);
    auto residual = product(times_transposed(g_inverse, g), a.lambda);
    add_to(residual, product(g_inverse, p));
    EXPECT_LE(largest_entry(residual), kRoundOff);
    auto force = transposed_times(g, a.lambda);
    add_to(force, p);
    EXPECT_LE(largest_change(a.rate.q_dot, product(inverse, force)), kRoundOff);
  });
}

// H_y = 0 at the solution, and q' = H_p, p' = -H_q at frozen y: all by Jets from H.
template <class System, class Q>
void check_partial_derivatives(const System& system, const Q& q, const Q& p) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  const Solved a(system, q, p);
  const auto by_y = gradient(
      [&](const auto& y) {
        using J = Jet<double, m>;
        return system.hamiltonian(J(0), unseeded<J>(q), unseeded<J>(p), y);
      },
      a.y);
  EXPECT_LE(largest_entry(by_y), kRoundOff);
  using J = Jet<double, n>;
  const auto yj = unseeded<J>(a.y);
  const auto by_p =
      gradient([&](const auto& x) { return system.hamiltonian(J(0), unseeded<J>(q), x, yj); }, p);
  auto residual =
      gradient([&](const auto& x) { return system.hamiltonian(J(0), x, unseeded<J>(p), yj); }, q);
  EXPECT_LE(largest_change(by_p, a.rate.q_dot), kRoundOff);
  add_to(residual, a.rate.p_dot);
  EXPECT_LE(largest_entry(residual), kRoundOff);
}

TYPED_TEST(VelocityConstraintsTest, HamiltonianIsStationaryInY) {
  this->at_all_points([&](const auto& q, const auto& p) {
    check_partial_derivatives(this->framed_, q, p);
    check_partial_derivatives(this->plain_, q, p);
  });
}

// The envelope theorem: with y eliminated, H(q, p) has the same derivatives. By central differences
// of fourth order: truncation d^4 and round-off eps / d are both below 1e-11 at d = 1e-3.
TYPED_TEST(VelocityConstraintsTest, ReducedHamiltonianHasTheSameDerivatives) {
  constexpr double kStep = 1e-3;
  constexpr double kTolerance = 1e-9;  // fifth derivatives of the scenes here are below 1e3
  const auto reduced = [&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    return this->framed_.hamiltonian(0.0, q, p, a.y);
  };
  const auto derivative = [&](const auto& f) {
    return (8 * (f(kStep) - f(-kStep)) - (f(2 * kStep) - f(-2 * kStep))) / (12 * kStep);
  };
  const auto shifted = [](auto x, int i, double d) {
    x[i] += d;
    return x;
  };
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    for (int i = 0; i < TypeParam::kDof; ++i) {
      const double by_q = derivative([&](double d) { return reduced(shifted(q, i, d), p); });
      const double by_p = derivative([&](double d) { return reduced(q, shifted(p, i, d)); });
      EXPECT_NEAR(by_q, -a.rate.p_dot[i], kTolerance);
      EXPECT_NEAR(by_p, a.rate.q_dot[i], kTolerance);
    }
  });
}

// H = p.q' - L, and L, speed agree with M.
TYPED_TEST(VelocityConstraintsTest, LegendreTransform) {
  this->at_all_points([&](const auto& q, const auto& p) {
    const Solved a(this->framed_, q, p);
    const auto& v = a.rate.q_dot;
    const double h = this->framed_.hamiltonian(0.0, q, p, a.y);
    EXPECT_NEAR(dot(p, v) - this->framed_.lagrangian(q, v), h, kRoundOff);
    const double kinetic = h - this->framed_.potential(q);
    EXPECT_NEAR(std::pow(this->framed_.speed(q, v), 2), 2 * kinetic, kRoundOff);
  });
}

// project() is the projection on ker G that is orthogonal in the norm of mass_norm.h.
TYPED_TEST(VelocityConstraintsTest, ProjectionIsOrthogonalAndIdempotent) {
  this->at_all_points([&](const auto& q, const auto& p) {
    auto v = p;
    ASSERT_EQ(this->framed_.project(q, v), RateStatus::kOk);
    EXPECT_LE(largest_entry(this->framed_.constraint(q, v)), kRoundOff);
    const auto b = this->framed_.scene().frame(q);
    auto pushed = p;
    const auto mass = this->framed_.scene().mass(q);
    for (int j = 0; j < TypeParam::kDof; ++j) {
      pushed[j] = (p[j] - v[j]) * (mass(j, j) > 0 ? mass(j, j) : 1);
    }
    EXPECT_LE(largest_entry(transposed_times(b, pushed)), kRoundOff);
    auto again = v;
    ASSERT_EQ(this->framed_.project(q, again), RateStatus::kOk);
    EXPECT_LE(largest_change(again, v), kRoundOff);
  });
}

// p -> M v - G' lambda -> (v, lambda) is the identity: rate() inverts momentum().
TYPED_TEST(VelocityConstraintsTest, RateInvertsMomentum) {
  Generator generator(12);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = random_vector<TypeParam::kDof>(generator, 2);
    const auto u = random_vector<TypeParam::kDof - TypeParam::kMultipliers>(generator, 2);
    const auto lambda = random_vector<TypeParam::kMultipliers>(generator, 2);
    const auto v = product(this->framed_.scene().frame(q), u);
    const auto p = this->framed_.momentum(q, v, lambda);
    const Solved a(this->framed_, q, p);
    EXPECT_LE(largest_change(a.rate.q_dot, v), kRoundOff);
    EXPECT_LE(largest_change(a.y, u), kRoundOff);
    EXPECT_LE(largest_change(a.lambda, lambda), kRoundOff);
  }
}

}  // namespace
}  // namespace carnot::velocity_constraints_test
