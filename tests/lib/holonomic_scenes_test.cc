// The scenes with attitudes and tangent directions: RATTLE against the same physics in angles, and
// the laws of the method on them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "testing/holonomic_laws.h"

namespace carnot::holonomic_scenes_test {
namespace {

template <class Runs>
class HolonomicScenesTest : public ::testing::Test {};
using Pairs = ::testing::Types<test::HolonomicRuns<test::SkateOnSpherePair>,
                               test::HolonomicRuns<test::SatellitePair>,
                               test::HolonomicRuns<test::PlateBallPair>>;
TYPED_TEST_SUITE(HolonomicScenesTest, Pairs);

TYPED_TEST(HolonomicScenesTest, SameMotionAsTheReducedScene) {
  test::expect_same_motion_as_reduced<TypeParam>();
}
TYPED_TEST(HolonomicScenesTest, OrderTwo) { test::expect_order<TypeParam>(2, {20, 28, 40, 56}); }
TYPED_TEST(HolonomicScenesTest, OrderFourByComposition) {
  test::expect_order<TypeParam>(4, {10, 14, 20, 28});
}
TYPED_TEST(HolonomicScenesTest, SymplecticOnTheManifold) {
  test::expect_symplectic_on_manifold<TypeParam>();
}
TYPED_TEST(HolonomicScenesTest, TangentOfTheMap) { test::expect_tangent_of_the_map<TypeParam>(); }
TYPED_TEST(HolonomicScenesTest, Reversible) { test::expect_reversible<TypeParam>(); }
TYPED_TEST(HolonomicScenesTest, ConstraintsAtRoundOffOverManySteps) {
  test::expect_constraints_at_round_off<TypeParam>(0.05, 10000);
}

// Quadratic invariants of symmetries that leave h alone: kept to the rounding of each step.
template <class Runs, class Invariants>
void expect_kept(const Invariants& invariants) {
  constexpr double kTolerance = 1e-12;  // a random walk of 1e4 steps of a few eps each
  test::Generator generator(12);
  auto z = Runs::random_start(generator);
  const auto before = invariants(z.value);
  ASSERT_TRUE(Runs::run(2, 500, 10000, z).completed());
  EXPECT_LE((invariants(z.value) - before).cwiseAbs().maxCoeff(), kTolerance);
}

// Turns of space: x cross p_x + e cross p_e.
TEST(SkateOnSphereTest, AngularMomentum) {
  expect_kept<test::HolonomicRuns<test::SkateOnSpherePair>>([](const Vector<double, 12>& z) {
    const Vector<double, 3> x = z.head<3>();
    const Vector<double, 3> e = z.segment<3>(3);
    return Vector<double, 3>(x.cross(z.segment<3>(6)) + e.cross(z.tail<3>()));
  });
}
TEST(SatelliteQuaternionTest, AngularMomentumInSpace) {
  expect_kept<test::HolonomicRuns<test::SatellitePair>>([](const Vector<double, 8>& z) {
    const Matrix<double, 4, 4> turns = 0.25 * space_rates(Vector<double, 4>(z.head<4>()));
    return Vector<double, 3>((turns * z.tail<4>()).tail<3>());
  });
}
// Shifts and turns of the plane, turns of the ball before it is put down.
TEST(PlateBallQuaternionTest, Momenta) {
  expect_kept<test::HolonomicRuns<test::PlateBallPair>>([](const Vector<double, 12>& z) {
    const Vector<double, 4> q = z.segment<4>(2);
    const Vector<double, 4> p = z.tail<4>();
    Vector<double, 6> kept;
    kept << z[6], z[7], (0.25 * body_rates(q) * p).tail<3>(),
        z[0] * z[7] - z[1] * z[6] + 0.25 * (space_rates(q) * p)[3];
    return kept;
  });
}

// Of the plate-ball quadrature p_x' = p_y' = 0: bit for bit.
TEST(PlateBallQuaternionTest, CyclicMomentaBitForBit) {
  using Runs = test::HolonomicRuns<test::PlateBallPair>;
  test::Generator generator(13);
  auto z = Runs::random_start(generator);
  const Vector<double, 2> before = z.value.segment<2>(6);
  ASSERT_TRUE(Runs::run(2, 10, 100, z).completed());
  EXPECT_EQ(z.value.segment<2>(6), before);
}

TEST(PlateBallQuaternionTest, EnergyDoesNotDrift) {
  test::expect_bounded_energy<test::HolonomicRuns<test::PlateBallPair>>(0.1, 20000);
}

// Where Euler angles are singular, at cos(theta) = 0, nothing happens.
TEST(SatelliteQuaternionTest, PassesTheSingularityOfTheAngles) {
  using Runs = test::HolonomicRuns<test::SatellitePair>;
  const double half = std::numbers::pi / 4;
  const Vector<double, 4> q(std::cos(half), 0, std::sin(half), 0);  // theta = pi/2
  Vector<double, 4> p(0.3, 0.2, -0.1, 0.4);
  ASSERT_EQ(project_momentum(Runs::System(test::SatellitePair::kFull), 0.0, q, p), RateStatus::kOk);
  auto z = make_state<double, 4>(q, p);
  const double energy = Runs::measure(z).energy;
  ASSERT_TRUE(Runs::run(8, 1, 60, z).completed());
  EXPECT_NEAR(Runs::measure(z).energy, energy, 1e-13);
  const VelocityConstraints<scenes::Satellite> chart(test::SatellitePair::kReduced);
  Rate<double, 3> rate;
  Vector<double, 2> u;
  EXPECT_EQ(
      chart.rate(
          0.0, Vector<double, 3>(0, std::numbers::pi / 2, 0), Vector<double, 3>(0, 0, 0), u, rate),
      RateStatus::kChart);
}

}  // namespace
}  // namespace carnot::holonomic_scenes_test
