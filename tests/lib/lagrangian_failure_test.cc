// Legendre transforms and projections that fail: each with its reason, and nothing changed.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/scenes/appell.h"
#include "carnot/system/lagrangian_system.h"
#include "testing/random_points.h"

namespace carnot::lagrangian_failure_test {
namespace {

constexpr double kEps = epsilon<double>();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Q = Vector<double, 3>;
using Lambda = Vector<double, 1>;
const Q kOrigin(0, 0, 0);

// |p| < 1: L = sqrt(1 + v^2).
struct BoundedMomentum {
  static constexpr int kDof = 1;
  static constexpr int kMultipliers = 0;

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/,
                             const Vector<T, 1>& /*q*/,
                             const Vector<T, 1>& v) const {
    using std::sqrt;
    return sqrt(constant<T>(1) + v[0] * v[0]);
  }
};

// x'^2 + y'^2 + 1 = 0 has no solution at all; x'^2 + y'^2 = 1 a circle of them.
struct UnitSpeed {
  static constexpr int kDof = 2;
  static constexpr int kMultipliers = 1;

  double squared_speed = 1;

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/,
                             const Vector<T, 2>& /*q*/,
                             const Vector<T, 2>& v) const {
    return constant<T>(0.5) * dot(v, v);
  }
  template <class T>
  [[nodiscard]] Vector<T, 1> constraint(const Vector<T, 2>& /*q*/, const Vector<T, 2>& v) const {
    return Vector<T, 1>(dot(v, v) - constant<T>(squared_speed));
  }
};

template <class Scene, int n = Scene::kDof, int m = Scene::kDof + Scene::kMultipliers>
RateStatus cold_rate(const Scene& scene, const Vector<double, n>& p) {
  const Vector<double, n> q = Vector<double, n>::Zero();
  Vector<double, m> y = Vector<double, m>::Zero();
  Rate<double, n> rate;
  const RateStatus status = LagrangianSystem<Scene>(scene).rate(0.0, q, p, y, rate);
  if (status == RateStatus::kOk) {
    EXPECT_TRUE(rate.q_dot.allFinite() && rate.p_dot.allFinite());
  } else {
    EXPECT_TRUE((y.array() == 0).all());
  }
  return status;
}

// At rest G = dg/dv vanishes; along the axis of the cone the direction is lost.
TEST(LagrangianFailureTest, NotOfIndexOne) {
  const LagrangianSystem<scenes::Appell> system{{}};
  EXPECT_EQ(cold_rate(scenes::Appell{}, kOrigin), RateStatus::kNotIndexOne);
  EXPECT_EQ(cold_rate(scenes::Appell{}, Q(0, 0, 1)), RateStatus::kNotIndexOne);
  EXPECT_EQ(cold_rate(scenes::Appell{}, Q(1e-3, 0, 1)), RateStatus::kOk);

  const Vector<double, 4> rest(0, 0, 0, 0.2);
  const Regularity at_rest = system.regularity(0.0, kOrigin, kOrigin, rest);
  EXPECT_EQ(at_rest.determinant, 0);
  EXPECT_EQ(at_rest.condition, kInfinity);
  const Vector<double, 4> nearly(1e-9, 0, 1e-9, 0.2);
  EXPECT_GE(system.regularity(0.0, kOrigin, kOrigin, nearly).condition, 1e15);

  Vector<double, 4> y = rest;
  Rate<double, 3> rate;
  EXPECT_EQ(system.rate(0.0, kOrigin, kOrigin, y, rate), RateStatus::kNotIndexOne);
  EXPECT_EQ(system.branch(0.0, kOrigin, kOrigin, Lambda(0.2), y), RateStatus::kNotIndexOne);
  EXPECT_EQ(y, rest);
}

TEST(LagrangianFailureTest, NoSolution) {
  using One = Vector<double, 1>;
  EXPECT_EQ(cold_rate(BoundedMomentum{}, One(0.8)), RateStatus::kOk);
  EXPECT_EQ(cold_rate(BoundedMomentum{}, One(1.5)), RateStatus::kNoSolution);
  const LagrangianSystem<BoundedMomentum> bounded{{}};
  One v(7);
  EXPECT_EQ(bounded.branch(0.0, One(0), One(1.5), {}, v), RateStatus::kNoSolution);
  EXPECT_EQ(v[0], 7);

  const Vector<double, 2> p(0.3, 0.4);
  EXPECT_EQ(cold_rate(UnitSpeed{1}, p), RateStatus::kOk);
  EXPECT_EQ(cold_rate(UnitSpeed{-1}, p), RateStatus::kNoSolution);
  const LagrangianSystem<UnitSpeed> impossible{{-1}};
  Vector<double, 3> y(1, 2, 3);
  EXPECT_EQ(impossible.branch(0.0, p, p, Lambda(1), y), RateStatus::kNoSolution);
  EXPECT_EQ(y, (Vector<double, 3>(1, 2, 3)));
}

TEST(LagrangianFailureTest, NotFinite) {
  for (const double bad : {kNan, kInfinity}) {
    EXPECT_EQ(cold_rate(scenes::Appell{}, Q(1, bad, 0.5)), RateStatus::kNotFinite);
  }
}

// ----- projection on the admissible velocities

TEST(LagrangianFailureTest, ProjectionOnTheCone) {
  const LagrangianSystem<scenes::Appell> system{{}};
  test::Generator generator(5);
  for (int sample = 0; sample < 20; ++sample) {
    const Q velocity = test::random_vector<3>(generator);
    Q v = velocity;
    Q p;
    const double violated = system.admissible_momentum(0.0, kOrigin, v, Lambda(0.3), p);
    EXPECT_NEAR(violated, (v - velocity).norm() / velocity.norm(), 4 * kEps);
    EXPECT_LE(system.constraint(kOrigin, v).norm(), 16 * kEps);
    EXPECT_LE((p - Q(0.4 * v[0], 0.4 * v[1], 1.6 * v[2])).norm(), 16 * kEps);
    const Q once = v;
    EXPECT_LE(system.admissible_momentum(0.0, kOrigin, v, Lambda(0.3), p), 16 * kEps / v.norm());
    EXPECT_LE((v - once).norm(), 16 * kEps);
  }
  Q v = kOrigin;  // at rest is admissible
  Q p;
  EXPECT_EQ(system.admissible_momentum(0.0, kOrigin, v, Lambda(0.3), p), 0);
  EXPECT_EQ(p, kOrigin);
}

TEST(LagrangianFailureTest, ProjectionThatFails) {
  const Vector<double, 2> q(0, 0);
  const Vector<double, 2> velocity(1, 0.5);
  Vector<double, 2> v = velocity;
  const LagrangianSystem<UnitSpeed> impossible{{-1}};
  EXPECT_EQ(impossible.project(0.0, q, v), RateStatus::kNoSolution);
  EXPECT_EQ(v, velocity);
  Vector<double, 2> p;
  EXPECT_TRUE(std::isnan(impossible.admissible_momentum(0.0, q, v, Lambda(0), p)));
  // At rest the unit circle has no nearest point.
  const LagrangianSystem<UnitSpeed> circle{{1}};
  v.setZero();
  EXPECT_EQ(circle.project(0.0, q, v), RateStatus::kConstraintRank);
  v[0] = kNan;
  EXPECT_EQ(circle.project(0.0, q, v), RateStatus::kNotFinite);
}

}  // namespace
}  // namespace carnot::lagrangian_failure_test
