// Failure codes of OptimalControl: what is wrong is named, and never a silent NaN.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "testing/control_forms.h"
#include "testing/control_scene_list.h"
#include "testing/random_points.h"

namespace carnot::control_failure_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class Scene>
RateStatus status(const Scene& scene,
                  const Vector<double, Scene::kDof>& q,
                  const Vector<double, Scene::kDof>& p) {
  Vector<double, Scene::kControls> u = Vector<double, Scene::kControls>::Zero();
  Rate<double, Scene::kDof> rate;
  const RateStatus status = OptimalControl<Scene>(scene).rate(0.0, q, p, u, rate);
  if (status == RateStatus::kOk) {
    EXPECT_TRUE(rate.q_dot.allFinite() && rate.p_dot.allFinite());
  }
  return status;
}

// R = diag(1, q): two controls of one coordinate, x' = u1 + u2, one of them free of cost at q = 0.
struct FadingWeight {
  static constexpr int kDof = 1;
  static constexpr int kControls = 2;

  template <class T>
  [[nodiscard]] Matrix<T, 1, 2> frame(const Vector<T, 1>& /*q*/) const {
    return {constant<T>(1), constant<T>(1)};
  }
  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> control_weight(const Vector<T, 1>& q) const {
    Matrix<T, 2, 2> r = Matrix<T, 2, 2>::Constant(constant<T>(0));
    r(0, 0) = constant<T>(1);
    r(1, 1) = q[0];
    return r;
  }
};

using One = Vector<double, 1>;

TEST(ControlFailureTest, WeightNotPositive) {
  EXPECT_EQ(status(FadingWeight{}, One(2), One(1)), RateStatus::kOk);
  for (const double q : {0.0, -1.0}) {
    EXPECT_EQ(status(FadingWeight{}, One(q), One(1)), RateStatus::kNotIndexOne);
  }
  EXPECT_EQ(status(FadingWeight{}, One(kNan), One(1)), RateStatus::kNotFinite);
  const OptimalControl<FadingWeight> system{{}};
  EXPECT_TRUE(std::isnan(system.speed(One(-1), One(1))));
  EXPECT_TRUE(std::isnan(system.speed(One(0), One(1))));
}

// More controls than coordinates: the cheapest of those that give v. The general route does not
// look for it, and says so.
TEST(ControlFailureTest, MoreControlsThanCoordinates) {
  const OptimalControl<FadingWeight> linear{{}};
  const One q(2);
  One v(3);
  One p;
  EXPECT_EQ(linear.admissible_momentum(0.0, q, v, Vector<double, 0>(), p), 0);
  EXPECT_NEAR(p[0], 2, 8 * kEps);  // u1 = p, u2 = p/2
  EXPECT_NEAR(linear.speed(q, v), std::sqrt(6), 8 * kEps);
  const OptimalControl<test::ByNewton<FadingWeight>> general{{}};
  EXPECT_TRUE(std::isnan(general.admissible_momentum(0.0, q, v, Vector<double, 0>(), p)));
}

TEST(ControlFailureTest, ChartOfTheBicycle) {
  constexpr double kRightAngle = std::numbers::pi / 2;
  const Vector<double, 4> p(1, 2, 3, 4);
  EXPECT_EQ(status(scenes::Bicycle{}, {0, 0, 0, kRightAngle - 1e-3}, p), RateStatus::kOk);
  EXPECT_EQ(status(scenes::Bicycle{}, {0, 0, 0, kRightAngle}, p), RateStatus::kChart);
  EXPECT_EQ(status(scenes::Bicycle{}, {0, 0, 0, -kRightAngle}, p), RateStatus::kChart);
  const OptimalControl<scenes::Bicycle> system{{}};
  const Vector<double, 4> q(0, 0, 0, kRightAngle);
  Vector<double, 4> v(0, 0, 0, 1);
  Vector<double, 4> out;
  EXPECT_TRUE(std::isnan(system.admissible_momentum(0.0, q, v, Vector<double, 0>(), out)));
}

// Without momentum the boat has no heading.
TEST(ControlFailureTest, HeadingOfTheBoatAtRest) {
  EXPECT_EQ(status(scenes::Boat{}, {0.1, 0.2}, {1e-3, 0}), RateStatus::kOk);
  EXPECT_EQ(status(scenes::Boat{}, {0.1, 0.2}, {0, 0}), RateStatus::kNotIndexOne);
}

// l = exp(u), f = u: u = log p, and no solution where p < 0.
struct ExponentialCost {
  static constexpr int kDof = 1;
  static constexpr int kControls = 1;

  template <class T>
  [[nodiscard]] Vector<T, 1> dynamics(const T& /*t*/,
                                      const Vector<T, 1>& /*q*/,
                                      const Vector<T, 1>& u) const {
    return u;
  }
  template <class T>
  [[nodiscard]] T running_cost(const T& /*t*/,
                               const Vector<T, 1>& /*q*/,
                               const Vector<T, 1>& u) const {
    using std::exp;
    return exp(u[0]);
  }
};
TEST(ControlFailureTest, NoStationaryControl) {
  const OptimalControl<ExponentialCost> system{{}};
  One u(0);
  Rate<double, 1> rate;
  ASSERT_EQ(system.rate(0.0, One(0), One(3), u, rate), RateStatus::kOk);
  EXPECT_NEAR(u[0], std::log(3), 4 * kEps);
  EXPECT_EQ(status(ExponentialCost{}, One(0), One(-1)), RateStatus::kNoSolution);
}

// A velocity out of reach, by Gauss-Newton as by the linear formula.
TEST(ControlFailureTest, VelocityOutOfReach) {
  const OptimalControl<scenes::Pendulum> linear{{}};
  const OptimalControl<test::ByNewton<scenes::Pendulum>> general{{}};
  const Vector<double, 2> q(0.3, 0.5);
  Vector<double, 2> v(2, 1);
  Vector<double, 2> w = v;
  Vector<double, 2> p_linear;
  Vector<double, 2> p_general;
  const double expected = 1.5 / v.norm();  // theta' = 0.5 whatever u is
  EXPECT_NEAR(
      linear.admissible_momentum(0.0, q, v, Vector<double, 0>(), p_linear), expected, 4 * kEps);
  EXPECT_NEAR(
      general.admissible_momentum(0.0, q, w, Vector<double, 0>(), p_general), expected, 4 * kEps);
  EXPECT_LE((v - w).norm() + (p_linear - p_general).norm(), 8 * kEps);
  // Nothing asked for, but the drift has to be met: relative to that.
  Vector<double, 2> rest(0, 0);
  const double residual = linear.admissible_momentum(0.0, q, rest, Vector<double, 0>(), p_linear);
  EXPECT_NEAR(residual, 0.5 / std::hypot(0.5, std::sin(0.3)), 4 * kEps);
}

template <class Scene>
class ControlNotFiniteTest : public ::testing::Test {};
TYPED_TEST_SUITE(ControlNotFiniteTest, test::ControlScenes, test::SceneNames);

// A bad number among q or p either is seen or does not matter: one that no formula reads.
TYPED_TEST(ControlNotFiniteTest, IsReportedOrDoesNotEnter) {
  constexpr int n = TypeParam::kDof;
  const auto seen = [](RateStatus s) { return s != RateStatus::kOk; };
  test::Generator generator(1);
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int i = 0; i < n; ++i) {
      auto q = test::random_vector<n>(generator);
      auto p = test::random_vector<n>(generator);
      p[i] = bad;
      EXPECT_TRUE(seen(status(TypeParam{}, q, p))) << "p[" << i << "] = " << bad;
      p[i] = 0.5;
      q[i] = bad;
      (void)status(TypeParam{}, q, p);  // finite where it says kOk
    }
  }
}

}  // namespace
}  // namespace carnot::control_failure_test
