// Failure codes of VelocityConstraints: what is wrong is named, and never a silent NaN.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "carnot/system/velocity_constraints.h"
#include "testing/failing_scenes.h"
#include "testing/random_points.h"
#include "testing/scene_list.h"
#include "testing/scene_wrappers.h"

namespace carnot::rate_status_test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class System>
RateStatus status(const System& system,
                  const Vector<double, System::kDof>& q,
                  const Vector<double, System::kDof>& p) {
  Vector<double, System::kAlgebraic> y = Vector<double, System::kAlgebraic>::Zero();
  Rate<double, System::kDof> rate;
  const RateStatus status = system.rate(0.0, q, p, y, rate);
  if (status == RateStatus::kOk) {
    EXPECT_TRUE(rate.q_dot.allFinite() && rate.p_dot.allFinite());
  }
  return status;
}

TEST(RateStatusTest, DependentConstraints) {
  const VelocityConstraints<test::DependentRows> system{{}};
  const Vector<double, 3> p(1, 2, 3);
  EXPECT_EQ(status(system, {0, 1, 0}, p), RateStatus::kOk);
  EXPECT_EQ(status(system, {0, 1e-3, 0}, p), RateStatus::kOk);
  EXPECT_EQ(status(system, {0, 0, 0}, p), RateStatus::kConstraintRank);
  EXPECT_EQ(status(system, {0, 1e-12, 0}, p), RateStatus::kConstraintRank);  // in round-off
  Vector<double, 2> lambda;
  EXPECT_EQ(system.multipliers(Vector<double, 3>(0, 0, 0), p, p, lambda),
            RateStatus::kConstraintRank);
  Vector<double, 3> v = p;
  EXPECT_EQ(system.project(Vector<double, 3>(0, 0, 0), v), RateStatus::kConstraintRank);
  EXPECT_EQ(v, p);  // untouched
}

// g = (0, q1, 0).
struct VanishingRow {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& q) const {
    return scenes::Heisenberg{}.mass(q);
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    return {constant<T>(0), q[0], constant<T>(0)};
  }
};

TEST(RateStatusTest, VanishingConstraint) {
  const VelocityConstraints<VanishingRow> system{{}};
  EXPECT_EQ(status(system, {1, 0, 0}, {1, 1, 1}), RateStatus::kOk);
  EXPECT_EQ(status(system, {0, 0, 0}, {1, 1, 1}), RateStatus::kConstraintRank);
}

TEST(RateStatusTest, MassNotPositiveOnAdmissibleVelocities) {
  const VelocityConstraints<test::FadingMass> framed{{}};
  const VelocityConstraints<test::FadingMasses> orthogonal{{}};
  const VelocityConstraints<test::WithoutFrame<test::FadingMass>> plain{{}};
  const Vector<double, 3> p(1, 2, 3);
  EXPECT_EQ(status(framed, {1, 0, 0}, p), RateStatus::kOk);
  EXPECT_EQ(status(orthogonal, {1, 0, 0}, p), RateStatus::kOk);
  EXPECT_EQ(status(orthogonal, {NAN, 0, 0}, p), RateStatus::kNotFinite);
  EXPECT_EQ(status(plain, {1, 0, 0}, p), RateStatus::kOk);
  for (const double q : {0.0, -1.0}) {
    EXPECT_EQ(status(orthogonal, {q, 0, 0}, p), RateStatus::kMassNotPositive);
    EXPECT_EQ(status(framed, {q, 0, 0}, p), RateStatus::kMassNotPositive);
    EXPECT_EQ(status(plain, {q, 0, 0}, p), RateStatus::kMassNotPositive);
  }
}

// No constraints is a case like any other.
TEST(RateStatusTest, UnconstrainedSystemIsPlainNewton) {
  const VelocityConstraints<test::RunAway> system{{}};
  Vector<double, 1> y;
  Rate<double, 1> rate;
  ASSERT_EQ(system.rate(0.0, Vector<double, 1>(2), Vector<double, 1>(3), y, rate), RateStatus::kOk);
  EXPECT_EQ(rate.q_dot[0], 3);
  EXPECT_EQ(rate.p_dot[0], 32);  // 4 q^3
}

template <class Scene>
class NotFiniteTest : public ::testing::Test {};
TYPED_TEST_SUITE(NotFiniteTest, test::Scenes, test::SceneNames);

// A bad number among q or p either is seen or does not matter: a coordinate that no formula reads.
TYPED_TEST(NotFiniteTest, IsReportedOrDoesNotEnter) {
  constexpr int n = TypeParam::kDof;
  const VelocityConstraints<TypeParam> framed{TypeParam{}};
  const VelocityConstraints<test::WithoutFrame<TypeParam>> plain{{TypeParam{}}};
  const auto seen = [](RateStatus s, bool may_be_unread) {
    return s == RateStatus::kNotFinite || (may_be_unread && s == RateStatus::kOk);
  };
  test::Generator generator(1);
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int i = 0; i < n; ++i) {
      auto q = test::random_vector<n>(generator);
      auto p = test::random_vector<n>(generator);
      q[i] = bad;
      EXPECT_TRUE(seen(status(framed, q, p), true)) << "q[" << i << "] = " << bad;
      EXPECT_TRUE(seen(status(plain, q, p), true)) << "q[" << i << "] = " << bad;
      q[i] = 0.5;
      p[i] = bad;
      EXPECT_EQ(status(framed, q, p), RateStatus::kNotFinite) << "p[" << i << "] = " << bad;
      EXPECT_EQ(status(plain, q, p), RateStatus::kNotFinite) << "p[" << i << "] = " << bad;
    }
  }
}

// V = -cos r at r = 0, where sqrt has no derivative: force and Hessian are those of r^2/2.
TEST(RateStatusTest, VehicleCosineIsSmoothAtTheOrigin) {
  using J = Jet<double, 8>;
  const VelocityConstraints<scenes::VehicleCosine> system{{}};
  Vector<double, 8> z;
  z << 0.5, 0, 0, 0.3, 0, 0, 0, 0;  // the midpoint (x - 1/2, y) is at the origin
  const Vector<J, 8> zj = seeded(z);
  Vector<J, 2> y;
  Rate<J, 4> rate;
  ASSERT_EQ(system.rate(J(0), Vector<J, 4>(zj.head<4>()), Vector<J, 4>(zj.tail<4>()), y, rate),
            RateStatus::kOk);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(rate.p_dot[i].a, 0);
    EXPECT_TRUE(rate.p_dot[i].v.allFinite());
  }
  EXPECT_NEAR(rate.p_dot[0].v[0], -1, 4 * std::numeric_limits<double>::epsilon());
  EXPECT_NEAR(rate.p_dot[1].v[1], -1, 4 * std::numeric_limits<double>::epsilon());
}

TEST(RateStatusTest, EveryFailureHasItsOwnSentence) {
  EXPECT_EQ(describe(RateStatus::kOk), "");
  std::set<std::string_view> sentences;
  for (const auto s :
       {RateStatus::kConstraintRank, RateStatus::kMassNotPositive, RateStatus::kNotFinite}) {
    EXPECT_FALSE(describe(s).empty());
    sentences.insert(describe(s));
  }
  EXPECT_EQ(sentences.size(), 3U);
}

}  // namespace
}  // namespace carnot::rate_status_test
