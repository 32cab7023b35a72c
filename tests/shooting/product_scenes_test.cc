// Scenes with holonomic constraints that go on off their manifold as a product (IsProduct).
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/conjugate_times.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/search/starts.h"
#include "catalogue/scene_choice.h"
#include "shooting/problems.h"

namespace carnot::internal::product_scenes_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A turn by `angle` about the axis (x, y, z), of length one.
std::vector<double> turn(double angle, double x, double y, double z) {
  const double sine = std::sin(angle / 2);
  return {std::cos(angle / 2), sine * x, sine * y, sine * z};
}

// The product of turns by yaw, pitch and roll.
std::vector<double> attitude(double psi, double theta, double phi) {
  const auto a = turn(psi, 0, 0, 1);
  const auto b = turn(theta, 0, 1, 0);
  const auto c = turn(phi, 1, 0, 0);
  const auto times = [](const std::vector<double>& p, const std::vector<double>& q) {
    return std::vector<double>{p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
                               p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
                               p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
                               p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1]};
  };
  return times(times(a, b), c);
}

// The scenes; the attitude is the last four coordinates of each.
class ProductScenesTest : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] Dynamics dynamics(const std::string& method) const {
    return apps::find_scene(GetParam()).make({}, method);
  }
  // A phase point of the manifold.
  [[nodiscard]] std::vector<double> start() const {
    const Dynamics flow = dynamics("gauss16");
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    std::vector<double> z(2 * flow.dof);
    for (double& x : z) x = normal(random);
    EXPECT_TRUE(flow.project_on_manifold(0, z));
    return z;
  }
  using Attitude = Eigen::Map<Eigen::Vector4d>;
  static Attitude attitude_of(std::vector<double>& z) {
    return Attitude(z.data() + z.size() / 2 - 4);
  }
  static Attitude momentum_of(std::vector<double>& z) { return Attitude(z.data() + z.size() - 4); }
};

// |q|^2 and q.p are quadratic invariants, which Gauss methods keep.
TEST_P(ProductScenesTest, StayOnTheManifoldWithoutForces) {
  const Dynamics flow = dynamics("gauss16");
  EXPECT_EQ(flow.holonomic, 1);
  EXPECT_EQ(flow.forced, 0);
  EXPECT_EQ(dynamics("rattle6").forced, 1);
  std::vector<double> z = start();
  const FlowSummary run = flow.monitored_flow(StepPlan::equal(0, 100, 2000), z, {});
  ASSERT_TRUE(run.completed());
  EXPECT_LE(run.holonomic_error, 1e3 * kEpsilon);  // a random walk of 2000 steps
}

TEST_P(ProductScenesTest, MoveAsRattleMovesThem) {
  constexpr double kTolerance = 1e-10;  // the error of rattle6
  std::vector<double> z = start();
  std::vector<double> by_rattle = z;
  ASSERT_TRUE(dynamics("gauss16").flow(StepPlan::equal(0, 2, 40), z).completed());
  ASSERT_TRUE(dynamics("rattle6").flow(StepPlan::equal(0, 2, 2000), by_rattle).completed());
  for (std::size_t i = 0; i < z.size(); ++i) EXPECT_NEAR(z[i], by_rattle[i], kTolerance) << i;
}

// Off the manifold log |q| is a free particle, and the rest moves as if it were not there.
TEST_P(ProductScenesTest, TheSizeOfTheQuaternionMovesApart) {
  constexpr double kTolerance = 1e-13;
  constexpr double kSize = 1.7;
  constexpr double kOutward = 0.3;
  const Dynamics flow = dynamics("gauss16");
  constexpr double kTime = 2;
  const StepPlan plan = StepPlan::equal(0, kTime, 64);
  std::vector<double> on = start();
  std::vector<double> off = on;
  // Momenta of the logarithm of the size and of the attitude: q.p, and p off q times |q|.
  attitude_of(off) *= kSize;
  momentum_of(off) /= kSize;
  momentum_of(off) += kOutward / kSize * attitude_of(on);
  ASSERT_TRUE(flow.flow(plan, on).completed());
  ASSERT_TRUE(flow.flow(plan, off).completed());
  // The rate of log |q|^2 is u3 = q.p / 2.
  const double size = kSize * std::exp(0.25 * kOutward * kTime);
  EXPECT_NEAR(attitude_of(off).norm(), size, kTolerance);
  EXPECT_NEAR(momentum_of(off).dot(attitude_of(off)), kOutward, kTolerance);
  attitude_of(off) /= size;
  for (int i = 0; i < flow.dof; ++i) EXPECT_NEAR(off[i], on[i], kTolerance) << i;
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         ProductScenesTest,
                         ::testing::Values("satellite-quaternion", "plate-ball-quaternion"));

// In the angles of yaw, pitch and roll, where they are regular on the way: one route against the
// other.
TEST(SatelliteQuaternion, GeodesicsAreThoseOfTheAngles) {
  constexpr double kTolerance = 1e-11;
  for (const std::array<double, 3>& angles :
       {std::array{0.4, 0.7, -0.5}, std::array{1.0, -0.3, 0.8}, std::array{-2.0, 0.2, 0.4}}) {
    const auto by_angles = find_geodesics(test::satellite({angles[0], angles[1], angles[2]}));
    const auto by_quaternion =
        find_geodesics(test::satellite_quaternion(attitude(angles[0], angles[1], angles[2])));
    ASSERT_FALSE(by_angles.geodesics.empty());
    ASSERT_FALSE(by_quaternion.geodesics.empty()) << by_quaternion.message;
    const Geodesic& a = by_angles.geodesics[0];
    const Geodesic& b = by_quaternion.geodesics[0];
    EXPECT_NEAR(a.action, b.action, kTolerance * a.action);
    EXPECT_EQ(a.label, Label::kLocallyMinimal);
    EXPECT_EQ(b.label, Label::kLocallyMinimal);
    // On the hidden constraint: q.p = 0 at q = 1.
    EXPECT_NEAR(b.p0[0], 0, 1e-9);
  }
}

// Every attitude, through what the angles cannot pass: a turn about an axis of the plane of the
// wheels is the shortest way up to pi.
TEST(SatelliteQuaternion, TurnsAboutAnAxisOfTheWheels) {
  for (const double angle : {2.0, 3.0, kPi}) {
    const auto report =
        find_geodesics(test::satellite_quaternion(turn(angle, std::cos(1), std::sin(1), 0)));
    ASSERT_FALSE(report.geodesics.empty()) << report.message;
    const Geodesic& best = report.geodesics[0];
    EXPECT_NEAR(best.action, angle * angle / 2, 1e-12);
    EXPECT_EQ(best.label, Label::kLocallyMinimal);
  }
}

// By a whole turn, in any direction of the plane: a continuum that ends where it is conjugate.
TEST(SatelliteQuaternion, AWholeTurnIsOneOfAContinuum) {
  const auto report = find_geodesics(test::satellite_quaternion({-1, 0, 0, 0}));
  ASSERT_FALSE(report.geodesics.empty()) << report.message;
  EXPECT_NEAR(report.geodesics[0].action, 2 * kPi * kPi, 1e-10);
  EXPECT_EQ(report.geodesics[0].label, Label::kSingular);
  EXPECT_EQ(report.geodesics[0].family_dimension, 1);
}

// With body rates (w1, w2) and momentum c about the third axis the attitude is
// exp(t (w + c e3)) exp(-t c e3): first conjugate when the first factor has turned once (Boscain &
// Rossi, SIAM J. Control Optim. 47, 2008).
TEST(SatelliteQuaternion, ConjugateTimesInClosedForm) {
  constexpr double kTolerance = 1e-12;
  constexpr long kSteps = 48;
  const BoundaryValueProblem problem = test::satellite_quaternion({1, 0, 0, 0});
  for (const std::array<double, 3>& body :
       {std::array{6.5, 0.0, 0.0}, std::array{0.0, 7.0, 0.0}, std::array{5.0, -3.0, 4.0}}) {
    const std::vector<double> p0{0, 2 * body[0], 2 * body[1], 2 * body[2]};
    const auto result = conjugate_times(problem, knots_of(problem, p0, 1, kSteps), kSteps);
    ASSERT_TRUE(result.known);
    ASSERT_FALSE(result.times.empty());
    const double rate = std::hypot(body[0], body[1], body[2]);
    EXPECT_NEAR(result.times[0], 2 * kPi / rate, kTolerance);
  }
}

// That form at t = 1, with w = |(w1, w2)| and r^2 = w^2 + c^2, ends at the target where
//
//   cos(r/2) + i (c/r) sin(r/2) = e^(ic/2) (q_w + i q_z),
//
// for one direction of (w1, w2) each. A grid of (w, c) has four roots with w <= 12: there |c| is
// below 25, since (w/r) sin(r/2) = 0.48.
TEST(SatelliteQuaternion, AllExtremalsInClosedForm) {
  const std::complex<double> target(0.6, 0.64);
  const std::array<double, 4> lengths{3.283059545, 5.165729352, 5.356600368, 11.459000414};
  GeodesicOptions options;
  options.all = true;
  options.max_length = 12;
  options.samples = 0;
  const auto report =
      find_geodesics(test::satellite_quaternion({target.real(), 0.48, 0, target.imag()}), options);
  ASSERT_EQ(report.geodesics.size(), lengths.size());
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const Geodesic& geodesic = report.geodesics[i];
    EXPECT_NEAR(geodesic.length.value_or(0), lengths[i], 1e-9);
    const double w = std::hypot(geodesic.p0[1], geodesic.p0[2]) / 2;
    const double c = geodesic.p0[3] / 2;
    const double r = std::hypot(w, c);
    const std::complex<double> turned(std::cos(r / 2), c / r * std::sin(r / 2));
    EXPECT_LE(std::abs(turned - std::polar(1.0, c / 2) * target), 1e-10);
    EXPECT_EQ(geodesic.label, i == 0 ? Label::kLocallyMinimal : Label::kConjugatePassed);
  }
}

TEST(SatelliteQuaternion, PathsStartOnTheManifold) {
  const BoundaryValueProblem problem = test::satellite_quaternion({-0.96, 0, 0.28, 0});
  for (int i = 0; i < 20; ++i) {
    const Path path = make_start(problem, 0, i).path;
    for (int node = 0; node <= path.intervals; ++node) {
      const Eigen::Map<const Eigen::Vector4d> q(path.configuration(node));
      EXPECT_NEAR(q.norm(), 1, 1e-12);
    }
  }
}

// Straight across the plane the ball turns about the axis at right angles: the shortest path, and
// abnormal as well as normal, so that grids have no discrete extremal near it.
TEST(PlateBallQuaternion, RollsStraight) {
  for (const double distance : {0.01, 0.5, 2.0, 7.0}) {
    std::vector<double> to{distance, 0};
    const auto turned = turn(distance, 0, 1, 0);
    to.insert(to.end(), turned.begin(), turned.end());
    const auto report = find_geodesics(test::plate_ball_quaternion(to));
    ASSERT_FALSE(report.geodesics.empty()) << report.message;
    EXPECT_NEAR(report.geodesics[0].action, distance * distance / 2, 1e-11);
    if (distance < 0.1) continue;  // round-off hides that it is abnormal
    EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
    EXPECT_EQ(report.geodesics[0].abnormal, true);
  }
}

// (1, 0; -2 j) moves nothing along it and may be added to p0: the path stays the same, and with it
// that it is shortest, but with much of it there are conjugate times.
TEST(PlateBallQuaternion, MultiplesOfAnAbnormalCovectorMislabelNothing) {
  const double distance = 7;
  const auto turned = turn(distance, 0, 1, 0);
  std::vector<double> to{distance, 0};
  to.insert(to.end(), turned.begin(), turned.end());
  const BoundaryValueProblem problem = test::plate_ball_quaternion(to);
  for (const double multiple : {-1.4, -80.0}) {
    const std::vector<double> p0{distance + multiple, 0, 0, 0, -2 * multiple, 0};
    Extremal extremal;
    extremal.knots = knots_of(problem, p0, 1, 64);
    extremal.geodesic.p0 = p0;
    extremal.geodesic.plan = StepPlan::equal(0, 1, 128);
    complete(problem, 0, extremal);
    EXPECT_NEAR(extremal.knots.at(1)[0], distance, 1e-12);
    EXPECT_EQ(extremal.geodesic.abnormal, true);
    const bool conjugate = multiple < -10;
    EXPECT_EQ(extremal.geodesic.morse_index.value_or(-1) > 0, conjugate);
    EXPECT_EQ(extremal.geodesic.label, conjugate ? Label::kUnknown : Label::kLocallyMinimal);
  }
}

// Attitudes that plate-ball, in angles, reaches seldom: each is reached, on the manifold.
TEST(PlateBallQuaternion, ReachesEveryAttitude) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 6; ++i) {
    std::vector<double> to{normal(random), normal(random)};
    Eigen::Vector4d q;
    for (double& x : q) x = normal(random);
    q.normalize();
    to.insert(to.end(), q.begin(), q.end());
    const auto report = find_geodesics(test::plate_ball_quaternion(to));
    ASSERT_FALSE(report.geodesics.empty()) << report.message;
    EXPECT_LE(report.geodesics[0].endpoint_error, 1e-10);
    EXPECT_EQ(report.geodesics[0].label, Label::kLocallyMinimal);
    EXPECT_LE(std::abs(report.geodesics[0].p0[2]), 1e-9);  // q.p = 0 at q = 1
  }
}

}  // namespace
}  // namespace carnot::internal::product_scenes_test
