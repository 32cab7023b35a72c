// What the headers of the scenes with holonomic constraints say of them: frames, derivatives by
// hand, symmetries, descriptions. No integration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "carnot/scene/describe_scene.h"
#include "carnot/scene/scene_info.h"
#include "testing/distance.h"
#include "testing/random_points.h"
#include "testing/reduced_scenes.h"
#include "testing/scene_wrappers.h"

namespace carnot::holonomic_scene_models_test {
namespace {

using test::distance;
using test::norm;

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kSamples = 20;

template <class Pair>
class HolonomicSceneModelsTest : public ::testing::Test {
 protected:
  static constexpr int kDof = test::FullScene<Pair>::kDof;
  static constexpr int kReducedDof = test::ReducedScene<Pair>::kDof;

  // Off the manifold too.
  Vector<double, kDof> configuration() { return test::random_vector<kDof>(generator_, 1.5); }

  test::Generator generator_{1};
  const test::FullScene<Pair> scene_ = Pair::kFull;
  const SceneInfo info_ = describe_scene(Pair::kFull);
};
using Pairs = ::testing::Types<test::RodSkatePair,
                               test::PendulumPair,
                               test::SkateOnSpherePair,
                               test::SatellitePair,
                               test::PlateBallPair>;
TYPED_TEST_SUITE(HolonomicSceneModelsTest, Pairs);

TYPED_TEST(HolonomicSceneModelsTest, DescribeThemselves) {
  constexpr auto n = static_cast<std::size_t>(TestFixture::kDof);
  EXPECT_FALSE(this->info_.name.empty());
  EXPECT_FALSE(this->info_.summary.empty());
  EXPECT_FALSE(this->info_.reference.empty());
  EXPECT_EQ(this->info_.kind, "velocity + holonomic constraints");
  ASSERT_EQ(this->info_.configuration.size(), n);
  std::set<std::string> names;
  for (const Coordinate& c : this->info_.configuration) {
    names.insert(c.name);
    EXPECT_FALSE(c.unit.empty());
  }
  EXPECT_EQ(names.size(), n);
  EXPECT_NO_THROW(validate(this->scene_));
}

// The reduced coordinates stay on h = 0, and their velocities obey the same velocity constraints.
TYPED_TEST(HolonomicSceneModelsTest, ReducedCoordinatesCoverTheManifold) {
  constexpr int m = TestFixture::kReducedDof;
  constexpr int k = test::FullScene<TypeParam>::kMultipliers;
  const VelocityConstraints<test::FullScene<TypeParam>> full(TypeParam::kFull);
  const VelocityConstraints<test::ReducedScene<TypeParam>> reduced(TypeParam::kReduced);
  for (int i = 0; i < kSamples; ++i) {
    const Vector<double, m> r = test::random_vector<m>(this->generator_);
    Vector<double, m> r_dot = test::random_vector<m>(this->generator_);
    ASSERT_EQ(reduced.project(r, r_dot), RateStatus::kOk);
    Vector<Jet<double, 1>, m> path;
    for (int j = 0; j < m; ++j) path[j] = Jet<double, 1>(r[j], Vector<double, 1>(r_dot[j]));
    const auto x = TypeParam::embed(path);
    Vector<double, TestFixture::kDof> q;
    Vector<double, TestFixture::kDof> v;
    for (int j = 0; j < TestFixture::kDof; ++j) {
      q[j] = x[j].a;
      v[j] = x[j].v[0];
    }
    EXPECT_LE(holonomic_residual(TypeParam::kFull, q), 16 * kEps);
    EXPECT_LE(hidden_residual(TypeParam::kFull, q, v), 64 * kEps);
    if constexpr (k > 0) {
      EXPECT_LE(norm(full.constraint(q, v)), 64 * kEps);
    }
    EXPECT_NEAR(full.lagrangian(q, v), reduced.lagrangian(r, r_dot), 64 * kEps);
  }
}

TYPED_TEST(HolonomicSceneModelsTest, MirrorsLeaveEverythingInvariant) {
  constexpr int n = TestFixture::kDof;
  using System = VelocityConstraints<test::FullScene<TypeParam>>;
  const System system(this->scene_);
  const auto hamiltonian = [&](const Vector<double, n>& q, const Vector<double, n>& p) {
    Vector<double, System::kAlgebraic> y;
    Rate<double, n> rate;
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    return system.hamiltonian(0.0, q, p, y);
  };
  EXPECT_FALSE(this->info_.symmetries.mirrors.empty());
  for (const auto& mirror : this->info_.symmetries.mirrors) {
    ASSERT_EQ(mirror.size(), static_cast<std::size_t>(n));
    const Vector<double, n> d = vector_at<n>(mirror.data());
    for (int i = 0; i < kSamples; ++i) {
      const auto q = this->configuration();
      const auto p = test::random_vector<n>(this->generator_);
      Vector<double, n> dq, dp;
      for (int j = 0; j < n; ++j) {
        dq[j] = d[j] * q[j];
        dp[j] = d[j] * p[j];
      }
      const double size = hamiltonian(q, p);
      EXPECT_NEAR(hamiltonian(dq, dp), size, 1e4 * kEps * std::max(1.0, size));
      EXPECT_EQ(test::largest_change(absolute(this->scene_.holonomic(dq)),
                                     absolute(this->scene_.holonomic(q))),
                0);
    }
  }
}

// Frame, B'M B and gradient by hand against the multipliers and Jets, off the manifold too.
TYPED_TEST(HolonomicSceneModelsTest, HandFormulasAgreeWithTheMultiplierRoute) {
  using Scene = test::FullScene<TypeParam>;
  constexpr int n = Scene::kDof;
  if constexpr (HasFrame<Scene>) {
    using Other = VelocityConstraints<test::WithoutFrame<Scene>>;
    const VelocityConstraints<Scene> by_hand(this->scene_);
    const Other other(test::WithoutFrame<Scene>{this->scene_});
    for (int i = 0; i < kSamples; ++i) {
      const auto q = this->configuration();
      const auto p = test::random_vector<n>(this->generator_);
      Vector<double, n - Scene::kMultipliers> u;
      Vector<double, Other::kAlgebraic> y;
      Rate<double, n> expected;
      Rate<double, n> rate;
      ASSERT_EQ(by_hand.rate(0.0, q, p, u, rate), RateStatus::kOk);
      ASSERT_EQ(other.rate(0.0, q, p, y, expected), RateStatus::kOk);
      // A factor of condition up to 1e3 at random points.
      const double scale = std::max(1.0, norm(expected.p_dot));
      EXPECT_LE(distance(rate.q_dot, expected.q_dot), 1e5 * kEps * scale);
      EXPECT_LE(distance(rate.p_dot, expected.p_dot), 1e5 * kEps * scale);
      const Matrix<double, n, n - Scene::kMultipliers> b = this->scene_.frame(q);
      EXPECT_LE(norm(product(this->scene_.constraints(q), b)), 64 * kEps);
      Matrix<double, n - Scene::kMultipliers, n - Scene::kMultipliers> reduced =
          transposed_times(b, product(this->scene_.mass(q), b));
      if constexpr (HasOrthogonalFrame<Scene>) {
        const auto masses = this->scene_.frame_masses(q);
        for (int j = 0; j < masses.size(); ++j) reduced(j, j) -= masses[j];
      } else {
        subtract_from(reduced, this->scene_.frame_mass(q));
      }
      EXPECT_LE(norm(reduced), 512 * kEps);
    }
  } else {
    static_assert(Scene::kMultipliers == 0, "nothing to frame");
  }
}

TEST(RodSkateTest, IsDrawnAsTheRodAndItsSkate) {
  const Vector<double, 4> q(1, 2, 1.6, 2.8);
  const auto lines = scenes::RodSkate{}.info().drawing.body(q.data());
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].points[0][0], q[0]);
  EXPECT_EQ(lines[0].points[1][1], q[3]);
  EXPECT_NEAR(0.5 * (lines[1].points[0][0] + lines[1].points[1][0]), 1.3, 4 * kEps);
}

// A quaternion and minus it are one attitude; products of rotations are products of quaternions.
TEST(QuaternionTest, RatesAreThoseOfProducts) {
  test::Generator generator(2);
  for (int i = 0; i < kSamples; ++i) {
    const auto q = test::random_vector<4>(generator);
    const auto v = test::random_vector<4>(generator);
    const Vector<double, 4> conj(q[0], -q[1], -q[2], -q[3]);
    Vector<double, 4> body = quaternion_product(conj, v);
    Vector<double, 4> space = quaternion_product(v, conj);
    add_to(body, body);
    add_to(space, space);
    EXPECT_LE(distance(product(body_rates(q), v), body), 16 * kEps);
    EXPECT_LE(distance(product(space_rates(q), v), space), 16 * kEps);
    const auto w = test::random_vector<4>(generator);
    const Vector<double, 4> left = quaternion_product(quaternion_product(q, v), w);
    const Vector<double, 4> right = quaternion_product(q, quaternion_product(v, w));
    EXPECT_LE(distance(left, right), 32 * kEps);
    EXPECT_NEAR(norm(quaternion_product(q, v)), norm(q) * norm(v), 16 * kEps);
  }
}

}  // namespace
}  // namespace carnot::holonomic_scene_models_test
