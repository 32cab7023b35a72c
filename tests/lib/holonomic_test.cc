// Holonomic constraints: derivatives by Jets, projections on the manifold, their failures.
#include "carnot/system/holonomic.h"

#include <gtest/gtest.h>

#include "carnot/scenes/rod_skate.h"
#include "carnot/scenes/skate_on_sphere.h"
#include "carnot/scenes/spherical_pendulum.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/system/velocity_constraints.h"
#include "testing/distance.h"
#include "testing/random_points.h"

namespace carnot::holonomic_test {
namespace {

using test::distance;
using test::largest_change;
using test::norm;

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
  // The third is x.e: its second derivative exchanges x and e. The first is |x|^2/2.
  Matrix<double, 3, 6> expected = filled<3, 6>(0.0);
  Matrix<double, 6, 6> exchange = filled<6, 6>(0.0);
  Matrix<double, 6, 6> of_x = filled<6, 6>(0.0);
  for (int i = 0; i < 3; ++i) {
    expected(0, i) = expected(2, 3 + i) = q[i];
    expected(1, 3 + i) = expected(2, i) = q[3 + i];
    exchange(i, 3 + i) = exchange(3 + i, i) = 1;
    of_x(i, i) = 1;
  }
  EXPECT_EQ(largest_change(dh, expected), 0);
  const auto hessians = holonomic_hessians(scene, q);
  EXPECT_EQ(largest_change(hessians[2], exchange), 0);
  EXPECT_EQ(largest_change(hessians[0], of_x), 0);
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
    Vector<double, 3> nearest = start;
    for (int j = 0; j < 3; ++j) nearest[j] *= 1.3 / norm(start);
    EXPECT_LE(distance(q, nearest), 8 * kEps);
  }
  Vector<double, 3> centre(0, 0, 0);
  EXPECT_FALSE(project_configuration(scene, centre));
  EXPECT_EQ(largest_change(centre, Vector<double, 3>(0, 0, 0)), 0);
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
    const Matrix<double, Scene::kHolonomic, Scene::kHolonomic> gram = times_transposed(dh, dh);
    Vector<double, n> change = p;
    subtract_from(change, start);
    const Vector<double, Scene::kHolonomic> nu =
        Cholesky<double, Scene::kHolonomic>(gram).solve(product(dh, change));
    EXPECT_LE(distance(change, transposed_times(dh, nu)), 64 * kEps);
    Vector<double, n> again = p;
    ASSERT_EQ(project_momentum(system, 0.0, q, again), RateStatus::kOk);
    EXPECT_LE(distance(again, p), 64 * kEps);
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
  EXPECT_EQ(largest_change(p, Vector<double, 4>(1, 2, 3, 4)), 0);
  const scenes::SkateOnSphere scene;
  const Vector<double, 6> q{{1, 0, 0, 1, 0, 0}};
  Matrix<double, 3, 3> inverse;
  const auto dh = holonomic_jacobian(scene, q);
  EXPECT_FALSE(invert_normal_mass(dh, identity<6, double>(), inverse));
}

// The test of rank does not depend on the scale of h.
TEST(HolonomicTest, RankIsIndependentOfScale) {
  using Square = Matrix<double, 2, 2>;
  const auto invertible = [](const Square& dh) {
    Square inverse;
    return invert_normal_mass(dh, identity<2, double>(), inverse);
  };
  EXPECT_TRUE(invertible(Square{{1e-9, 0}, {1e6, 1e6}}));
  EXPECT_FALSE(invertible(Square{{1e-9, 1e-9}, {1e6, 1e6}}));
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
  EXPECT_LE(distance(product(projector, projector), projector), kTolerance);
  EXPECT_LE(distance(test::transposed(projector), projector), kTolerance);
  double trace = 0;
  for (int i = 0; i < 6; ++i) trace += projector(i, i);
  EXPECT_NEAR(trace, 4, kTolerance);
  constexpr double kStep = 1e-5;  // error of the difference: its square
  Vector<double, 6> chord = point(0.4 + kStep);
  subtract_from(chord, point(0.4 - kStep));
  EXPECT_LE(distance(product(projector, chord), chord), 1e-8 * norm(chord));
}

}  // namespace
}  // namespace carnot::holonomic_test
