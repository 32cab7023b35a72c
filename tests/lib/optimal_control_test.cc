#include "carnot/system/optimal_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/system/phase_space.h"
#include "testing/control_forms.h"
#include "testing/control_scene_list.h"
#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::optimal_control_test {
namespace {

using test::Generator;
using test::largest_change;
using test::random_vector;

constexpr double kEps = std::numeric_limits<double>::epsilon();
// Points in [-1, 1]^n, momenta up to 2; Newton ends at round-off of H_u.
constexpr double kRoundOff = 200 * kEps;
constexpr int kSamples = 50;

// u, rate and H of a system at a point where all must be well.
template <class System>
struct Solved {
  static constexpr int n = System::kDof;
  Vector<double, System::kControls> u = filled<System::kControls>(0.0);
  Rate<double, n> rate;
  double h;

  Solved(const System& system, const Vector<double, n>& q, const Vector<double, n>& p) {
    EXPECT_EQ(system.rate(0.0, q, p, u, rate), RateStatus::kOk);
    h = system.hamiltonian(0.0, q, p, u);
  }
};

template <class A, class B>
void expect_same(const Solved<A>& a, const Solved<B>& b) {
  EXPECT_LE(largest_change(a.u, b.u), kRoundOff);
  EXPECT_LE(largest_change(a.rate.q_dot, b.rate.q_dot), kRoundOff);
  EXPECT_LE(largest_change(a.rate.p_dot, b.rate.p_dot), kRoundOff);
  EXPECT_NEAR(a.h, b.h, kRoundOff);
}

// The hard points by hand, then random ones.
template <int n, class Check>
void at_all_points(const Check& check) {
  using Q = Vector<double, n>;
  Generator generator(11);
  check(filled<n>(0.0), filled<n>(1.0));
  check(filled<n>(1e-8), filled<n>(-1e-8));
  for (int i = 0; i < kSamples; ++i) {
    const Q q = random_vector<n>(generator);
    check(q, random_vector<n>(generator, 2));
  }
}

template <class Scene>
class LinearControlTest : public ::testing::Test {
 protected:
  const OptimalControl<Scene> linear_{test::uneven<Scene>()};
  const OptimalControl<test::WithoutControlGradient<Scene>> by_jets_{{test::uneven<Scene>()}};
};
TYPED_TEST_SUITE(LinearControlTest, test::LinearControlScenes, test::SceneNames);

TYPED_TEST(LinearControlTest, WrappersHideWhatTheySay) {
  using Jets = test::WithoutControlGradient<TypeParam>;
  static_assert(HasControlGradient<TypeParam> && HasLinearControls<Jets>);
  static_assert(!HasControlGradient<Jets> && !HasLinearControls<test::ByNewton<TypeParam>>);
  static_assert(HasDrift<Jets> == HasDrift<TypeParam>);
  static_assert(HasStateCost<Jets> == HasStateCost<TypeParam>);
  static_assert(IndexOneSystem<OptimalControl<TypeParam>>);
}

TYPED_TEST(LinearControlTest, HandDerivativesAgreeWithJets) {
  at_all_points<TypeParam::kDof>([&](const auto& q, const auto& p) {
    expect_same(Solved(this->linear_, q, p), Solved(this->by_jets_, q, p));
  });
}

// The linear route against the general one: two controls, drift and state cost, a weight.
template <class Scene>
class NewtonRouteTest : public ::testing::Test {
 protected:
  const OptimalControl<Scene> linear_{Scene{}};
  const OptimalControl<test::ByNewton<Scene>> by_newton_{{Scene{}}};
};
using NewtonRoutes = ::testing::
    Types<scenes::Brockett, scenes::DoubleIntegrator, test::ControlForm<scenes::Heisenberg>>;
TYPED_TEST_SUITE(NewtonRouteTest, NewtonRoutes);

// d(rate)/dz by Jets, warm from u.
template <class System, class Q, class U>
Matrix<double, 2 * System::kDof, 2 * System::kDof> jacobian_of(const System& system,
                                                               const Q& q,
                                                               const Q& p,
                                                               const U& u) {
  Vector<double, 2 * System::kDof> z;
  store(q, z.data());
  store(p, z.data() + System::kDof);
  Matrix<double, 2 * System::kDof, 2 * System::kDof> jacobian;
  EXPECT_EQ(phase_jacobian(system, 0.0, z, u, jacobian), RateStatus::kOk);
  return jacobian;
}

TYPED_TEST(NewtonRouteTest, AgreesWithTheLinearOne) {
  at_all_points<TypeParam::kDof>([&](const auto& q, const auto& p) {
    const Solved a(this->linear_, q, p);
    const Solved b(this->by_newton_, q, p);
    expect_same(a, b);
    EXPECT_LE(largest_change(jacobian_of(this->linear_, q, p, a.u),
                             jacobian_of(this->by_newton_, q, p, b.u)),
              kRoundOff);
    EXPECT_NEAR(this->by_newton_.regularity(0, q, p, b.u).determinant,
                this->linear_.regularity(0, q, p, a.u).determinant,
                kRoundOff);
  });
}

template <class Scene>
class ControlTest : public ::testing::Test {
 protected:
  const OptimalControl<Scene> system_{test::uneven<Scene>()};
};
// One of each: a frame that loses rank, a chart, drift and state cost, the general route.
using OneOfEach =
    ::testing::Types<scenes::Grushin, scenes::Bicycle, scenes::DoubleIntegrator, scenes::Boat>;
TYPED_TEST_SUITE(ControlTest, OneOfEach, test::SceneNames);

// H_u = 0 at the solution, and q' = H_p, p' = -H_q at frozen u: all by Jets from H.
template <class System, class Q>
void check_partial_derivatives(const System& system, const Q& q, const Q& p) {
  using U = Jet<double, System::kControls>;
  using X = Jet<double, System::kDof>;
  const Solved a(system, q, p);
  const auto of_u = [&](const Vector<U, System::kControls>& u) {
    return system.hamiltonian(U(0), unseeded<U>(q), unseeded<U>(p), u);
  };
  const auto of_q = [&](const Vector<X, System::kDof>& x) {
    return system.hamiltonian(X(0), x, unseeded<X>(p), unseeded<X>(a.u));
  };
  EXPECT_LE(largest_entry(gradient(of_u, a.u)), kRoundOff);
  auto residual = gradient(of_q, q);
  add_to(residual, a.rate.p_dot);
  EXPECT_LE(largest_entry(residual), kRoundOff);
  EXPECT_LE(largest_change(system.dynamics(0.0, q, a.u), a.rate.q_dot), kRoundOff);
  EXPECT_NEAR(dot(p, a.rate.q_dot) - system.running_cost(0.0, q, a.u), a.h, kRoundOff);
}

TYPED_TEST(ControlTest, HamiltonianIsStationaryInTheControls) {
  at_all_points<TypeParam::kDof>(
      [&](const auto& q, const auto& p) { check_partial_derivatives(this->system_, q, p); });
}

// The derivative of the rate by Jets against central differences of fourth order: truncation d^4
// and round-off eps / d are below 1e-11 at d = 1e-3, times fifth derivatives up to 1e3.
template <class System, class Z>
void check_derivative_of_the_rate(const System& system, const Z& z) {
  constexpr double kStep = 1e-3;
  constexpr double kTolerance = 1e-8;
  Vector<double, System::kControls> u = filled<System::kControls>(0.0);
  const auto rate = [&](int i, double d) {
    Z moved = z;
    Z z_dot;
    moved[i] += d;
    EXPECT_EQ(phase_rate(system, 0.0, moved, u, z_dot), RateStatus::kOk);
    return z_dot;
  };
  rate(0, 0);
  Matrix<double, 2 * System::kDof, 2 * System::kDof> jacobian;
  ASSERT_EQ(phase_jacobian(system, 0.0, z, u, jacobian), RateStatus::kOk);
  for (int i = 0; i < 2 * System::kDof; ++i) {
    const Z right = rate(i, kStep), left = rate(i, -kStep);
    const Z far_right = rate(i, 2 * kStep), far_left = rate(i, -2 * kStep);
    for (int j = 0; j < 2 * System::kDof; ++j) {
      const double near = right[j] - left[j];
      const double far = far_right[j] - far_left[j];
      EXPECT_NEAR((8 * near - far) / (12 * kStep), jacobian(j, i), kTolerance);
    }
  }
}

TYPED_TEST(ControlTest, JetsAgreeWithDifferences) {
  constexpr int n = TypeParam::kDof;
  Generator generator(13);
  for (int sample = 0; sample < 5; ++sample) {
    Vector<double, 2 * n> z;
    store(random_vector<n>(generator), z.data());
    store(random_vector<n>(generator, 0.5), z.data() + n);
    for (int i = n; i < 2 * n; ++i) z[i] += 1;
    check_derivative_of_the_rate(this->system_, z);
  }
}

// v = f(t, q, u) -> p -> rate() gives v back, with l the least for that v.
TYPED_TEST(ControlTest, MomentumOfAnAdmissibleVelocity) {
  constexpr int n = TypeParam::kDof;
  constexpr double kTolerance = 2000 * kEps;  // v and p are solved for: condition numbers up to 10
  Generator generator(14);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = random_vector<n>(generator);
    const auto u = random_vector<TypeParam::kControls>(generator, 2);
    const Vector<double, n> wanted = this->system_.dynamics(0.0, q, u);
    Vector<double, n> v = wanted;
    Vector<double, n> p;
    EXPECT_LE(this->system_.admissible_momentum(0.0, q, v, Vector<double, 0>(), p), kTolerance);
    EXPECT_LE(largest_change(v, wanted), kTolerance);
    const Solved a(this->system_, q, p);
    EXPECT_LE(largest_change(a.rate.q_dot, wanted), kTolerance);
    EXPECT_NEAR(
        this->system_.running_cost(0.0, q, a.u), this->system_.running_cost(0.0, q, u), kTolerance);
  }
}

TYPED_TEST(ControlTest, SpeedIsThatOfTheCostWhereItIsAMetric) {
  constexpr int n = TypeParam::kDof;
  const bool metric = !HasDrift<TypeParam> && HasLinearControls<TypeParam>;
  at_all_points<n>([&](const auto& q, const auto& p) {
    const Solved a(this->system_, q, p);
    const double speed = this->system_.speed(q, a.rate.q_dot);
    EXPECT_EQ(std::isnan(speed), !metric);
    const double cost = this->system_.running_cost(0.0, q, a.u);
    if (metric) {
      EXPECT_NEAR(speed, std::sqrt(2 * cost), kRoundOff);
    }
  });
}

// The least-norm p of a velocity that control cannot give is that of the nearest it can.
TEST(OptimalControlTest, InadmissibleVelocitiesAreProjected) {
  const OptimalControl<scenes::Brockett> system{{}};
  const Vector<double, 3> q(0.3, -0.4, 2);
  const Vector<double, 3> normal(-q[1], q[0], -1);  // of the span of F
  const Vector<double, 3> admissible = product(system.scene().frame(q), Vector<double, 2>(1, 2));
  Vector<double, 3> v = admissible;
  for (int i = 0; i < 3; ++i) v[i] += 0.1 * normal[i];
  Vector<double, 3> p;
  const double residual = 0.1 * test::norm(normal) / test::norm(v);
  EXPECT_NEAR(system.admissible_momentum(0.0, q, v, Vector<double, 0>(), p), residual, 8 * kEps);
  EXPECT_LE(largest_change(v, admissible), 8 * kEps);
  EXPECT_NEAR(dot(p, normal), 0, 8 * kEps);
}

// On the singular line of the Grushin plane y' = 0 and y has no momentum of its own.
TEST(OptimalControlTest, FrameMayLoseRank) {
  const OptimalControl<scenes::Grushin> system{{}};
  const Vector<double, 2> q(0, 1);
  Vector<double, 2> v(3, 0);
  Vector<double, 2> p;
  EXPECT_EQ(system.admissible_momentum(0.0, q, v, Vector<double, 0>(), p), 0);
  EXPECT_EQ(largest_change(p, Vector<double, 2>(3, 0)), 0);
  EXPECT_EQ(system.speed(q, v), 3);
  Vector<double, 2> across(3, 4);
  EXPECT_EQ(system.admissible_momentum(0.0, q, across, Vector<double, 0>(), p), 0.8);
}

}  // namespace
}  // namespace carnot::optimal_control_test
