// Holonomic constraints: derivatives by Jets, projections on the manifold, their failures.
#include "carnot/system/holonomic.h"

#include <gtest/gtest.h>

#include "carnot/scenes/rod_skate.h"
#include "carnot/scenes/skate_on_sphere.h"
#include "carnot/scenes/spherical_pendulum.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/random_points.h"

namespace carnot::holonomic_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr int kSamples = 20;

static_assert(HolonomicSystem<VelocityConstraints<scenes::RodSkate>>);
static_assert(!HolonomicSystem<VelocityConstraints<scenes::Unicycle>>);

// By hand: rows (2x, 0), (0, 2e), (e, x) halved where the scene halves.
TEST(HolonomicTest, DerivativesOfTheSkateOnTheSphere) {
  const scenes::SkateOnSphere scene;
  test::Generator generator(1);
  const auto q = test::random_vector<6>(generator);
  const auto dh = holonomic_jacobian(scene, q);
  Matrix<double, 3, 6> expected = Matrix<double, 3, 6>::Zero();
  expected.row(0).head<3>() = q.head<3>().transpose();
  expected.row(1).tail<3>() = q.tail<3>().transpose();
  expected.row(2) << q.tail<3>().transpose(), q.head<3>().transpose();
  EXPECT_EQ(dh, expected);
  // The third is x.e: its second derivative exchanges x and e.
  Matrix<double, 6, 6> exchange = Matrix<double, 6, 6>::Zero();
  exchange.topRightCorner<3, 3>().setIdentity();
  exchange.bottomLeftCorner<3, 3>().setIdentity();
  const auto hessians = holonomic_hessians(scene, q);
  EXPECT_EQ(hessians[2], exchange);
  EXPECT_EQ(hessians[0],
            expected.row(0).cwiseProduct(expected.row(0)).cwiseSign().asDiagonal().toDenseMatrix());
}

TEST(HolonomicTest, ResidualsByHand) {
  const scenes::RodSkate scene;
  const Vector<double, 4> q(0, 0, 3, 4);
  EXPECT_EQ(holonomic_residual(scene, q), 24);
  EXPECT_EQ(hidden_residual(scene, q, Vector<double, 4>(1, 0, 2, 1)), 14);  // 2 d.(v2 - v1)
}

TEST(HolonomicTest, ProjectedConfigurationIsOnTheManifoldAndNearest) {
  const scenes::SphericalPendulum scene{1.3, 0.7};
  test::Generator generator(2);
  for (int i = 0; i < kSamples; ++i) {
    const auto start = test::random_vector<3>(generator, 3);
    Vector<double, 3> q = start;
    ASSERT_TRUE(project_configuration(scene, q));
    EXPECT_LE((q - 1.3 * start.normalized()).norm(), 8 * kEps);
  }
  Vector<double, 3> centre(0, 0, 0);
  EXPECT_FALSE(project_configuration(scene, centre));
  EXPECT_EQ(centre, (Vector<double, 3>(0, 0, 0)));
}

template <class Scene>
void expect_projected_momentum(const Scene& scene) {
  constexpr int n = Scene::kDof;
  const VelocityConstraints<Scene> system(scene);
  test::Generator generator(3);
  for (int i = 0; i < kSamples; ++i) {
    Vector<double, n> q = test::random_vector<n>(generator, 2);
    ASSERT_TRUE(project_configuration(scene, q));
    const auto start = test::random_vector<n>(generator, 2);
    Vector<double, n> p = start;
    ASSERT_EQ(project_momentum(system, 0.0, q, p), RateStatus::kOk);
    Vector<double, VelocityConstraints<Scene>::kAlgebraic> y;
    Rate<double, n> rate;
    ASSERT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    EXPECT_LE(hidden_residual(scene, q, rate.q_dot), 64 * kEps);
    // The change is along the rows of Dh, and there is none the second time.
    const auto dh = holonomic_jacobian(scene, q);
    const Matrix<double, Scene::kHolonomic, Scene::kHolonomic> gram = product(dh, dh.transpose());
    const Vector<double, n> change = p - start;
    const Vector<double, Scene::kHolonomic> nu = Cholesky<double, Scene::kHolonomic>(gram).solve(
        Vector<double, Scene::kHolonomic>(dh * change));
    EXPECT_LE((change - dh.transpose() * nu).norm(), 64 * kEps);
    Vector<double, n> again = p;
    ASSERT_EQ(project_momentum(system, 0.0, q, again), RateStatus::kOk);
    EXPECT_LE((again - p).norm(), 64 * kEps);
  }
}
TEST(HolonomicTest, ProjectedMomentumIsOnTheHiddenConstraint) {
  expect_projected_momentum(scenes::RodSkate{});
  expect_projected_momentum(scenes::SkateOnSphere{0.6});
}

// x parallel to e: the third row of Dh depends on the others.
TEST(HolonomicTest, DependentRowsAreRefused) {
  const VelocityConstraints<scenes::RodSkate> rod({});
  Vector<double, 4> p(1, 2, 3, 4);
  EXPECT_NE(project_momentum(rod, 0.0, Vector<double, 4>(1, 1, 1, 1), p), RateStatus::kOk);
  EXPECT_EQ(p, (Vector<double, 4>(1, 2, 3, 4)));
  const scenes::SkateOnSphere scene;
  Vector<double, 6> q;
  q << 1, 0, 0, 1, 0, 0;
  Matrix<double, 3, 3> inverse;
  const auto dh = holonomic_jacobian(scene, q);
  EXPECT_FALSE(
      invert_normal_mass(dh, Matrix<double, 6, 6>(Matrix<double, 6, 6>::Identity()), inverse));
}

// The test of rank does not depend on the scale of h.
TEST(HolonomicTest, RankIsIndependentOfScale) {
  const Matrix<double, 2, 2> identity = Matrix<double, 2, 2>::Identity();
  Matrix<double, 2, 2> dh;
  Matrix<double, 2, 2> inverse;
  dh << 1e-9, 0, 1e6, 1e6;
  EXPECT_TRUE(invert_normal_mass(dh, identity, inverse));
  dh << 1e-9, 1e-9, 1e6, 1e6;
  EXPECT_FALSE(invert_normal_mass(dh, identity, inverse));
}

// P is an orthogonal projector of rank 2(n - l), and curves on the manifold are tangent to it.
TEST(HolonomicTest, ManifoldProjector) {
  constexpr double kTolerance = 1e-13;
  const scenes::SphericalPendulum scene{1.3, 0.7};
  const VelocityConstraints<scenes::SphericalPendulum> system(scene);
  const auto point = [&](double s) {
    Vector<double, 3> q(std::cos(s), 0.3 + std::sin(2 * s), 0.5);
    Vector<double, 3> p(0.2, std::cos(s), s);
    EXPECT_TRUE(project_configuration(scene, q));
    EXPECT_EQ(project_momentum(system, 0.0, q, p), RateStatus::kOk);
    return make_state<double, 3>(q, p).value;
  };
  Matrix<double, 6, 6> projector;
  ASSERT_TRUE(manifold_projector(system, 0.0, point(0.4), projector));
  EXPECT_LE((projector * projector - projector).norm(), kTolerance);
  EXPECT_LE((projector.transpose() - projector).norm(), kTolerance);
  EXPECT_NEAR(projector.trace(), 4, kTolerance);
  constexpr double kStep = 1e-5;  // error of the difference: its square
  const Vector<double, 6> tangent = (point(0.4 + kStep) - point(0.4 - kStep)) / (2 * kStep);
  EXPECT_LE((projector * tangent - tangent).norm(), 1e-8 * tangent.norm());
}

}  // namespace
}  // namespace carnot::holonomic_test
