// Rates side by side against rates one by one.
#include "carnot/system/packed_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/step/gauss.h"
#include "testing/charted_scenes.h"
#include "testing/runs.h"
#include "testing/scene_wrappers.h"

namespace carnot::packed_rate_test {
namespace {

using test::Generator;
using test::random_vector;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// The largest difference of W lanes to W rates, over the size of the rate.
template <int W, class Lane, class System>
double defect(const System& system, unsigned seed) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  Generator generator(seed);
  std::array<double, W> t{};
  std::array<double, 2 * n * W> z;
  std::array<double, m * W> y;
  std::array<double, 2 * n * W> z_dot;
  for (double& x : z) x = random_vector<1>(generator, 1)[0];
  EXPECT_TRUE((packed_rate<W, System, Lane>(system, t.data(), z.data(), y.data(), z_dot.data())));
  double worst = 0;
  for (int l = 0; l < W; ++l) {
    Vector<double, 2 * n> point;
    Vector<double, 2 * n> packed;
    for (int k = 0; k < 2 * n; ++k) {
      point[k] = z[k * W + l];
      packed[k] = z_dot[k * W + l];
    }
    Vector<double, m> expected_y = Vector<double, m>::Zero();
    Vector<double, 2 * n> expected;
    EXPECT_EQ(phase_rate(system, 0.0, point, expected_y, expected), RateStatus::kOk);
    worst = std::max(worst, test::relative_distance(packed, expected));
    for (int k = 0; k < m; ++k) {
      const double size = std::max(1.0, expected_y.cwiseAbs().maxCoeff());
      worst = std::max(worst, std::abs(y[k * W + l] - expected_y[k]) / size);
    }
  }
  return worst;
}

template <class Scene>
class PackedRateTest : public ::testing::Test {};

using PackScenes = ::testing::Types<scenes::Vehicle,
                                    scenes::VehicleCosine,
                                    scenes::HeisenbergGroup,
                                    scenes::Unicycle,
                                    scenes::Trailers<2>,
                                    scenes::Satellite,
                                    scenes::FallingCat>;
TYPED_TEST_SUITE(PackedRateTest, PackScenes, test::SceneNames);

// The same formulas in another order of rounding, and sines to 2 ulp; solves with condition numbers
// up to 100.
constexpr double kRoundOff = 1000 * kEps;

TYPED_TEST(PackedRateTest, AgreesWithTheRateLaneByLane) {
  const VelocityConstraints<TypeParam> system(test::uneven<TypeParam>());
  for (unsigned seed = 1; seed < 20; ++seed) {
    EXPECT_LE((defect<8, pack_lane::Widest<8>::type>(system, seed)), kRoundOff);
    EXPECT_LE((defect<4, pack_lane::Widest<4>::type>(system, seed)), kRoundOff);
    EXPECT_LE((defect<8, double>(system, seed)), kRoundOff);
  }
}

// A_i of the tangent: the same Jets, on packs.
TYPED_TEST(PackedRateTest, JacobianAgreesLaneByLane) {
  constexpr int kLanes = 8;
  constexpr int n = TypeParam::kDof;
  const VelocityConstraints<TypeParam> system(test::uneven<TypeParam>());
  using Square = Matrix<double, 2 * n, 2 * n>;
  Generator generator(7);
  std::array<double, kLanes> t{};
  std::array<double, 2 * n * kLanes> z;
  std::array<double, kLanes> weights;
  std::array<double, 4 * n * n * kLanes> jacobian;
  for (double& x : z) x = random_vector<1>(generator, 1)[0];
  for (int l = 0; l < kLanes; ++l) weights[l] = 1 + l;
  ASSERT_TRUE(packed_jacobian<kLanes>(system, t.data(), z.data(), weights.data(), jacobian.data()));
  for (int l = 0; l < kLanes; ++l) {
    Vector<double, 2 * n> point;
    for (int k = 0; k < 2 * n; ++k) point[k] = z[k * kLanes + l];
    Vector<double, system.kAlgebraic> y = Vector<double, system.kAlgebraic>::Zero();
    Vector<double, 2 * n> rate;
    Square expected;
    ASSERT_EQ(phase_rate(system, 0.0, point, y, rate), RateStatus::kOk);
    ASSERT_EQ(phase_jacobian(system, 0.0, point, y, expected), RateStatus::kOk);
    Square packed;
    for (int r = 0; r < 2 * n; ++r) {
      for (int c = 0; c < 2 * n; ++c) packed(r, c) = jacobian[(2 * n * r + c) * kLanes + l];
    }
    EXPECT_LE(test::relative_distance(packed, Square(weights[l] * expected)), kRoundOff);
    ASSERT_TRUE(jacobian_in_pack(system, 0.0, point.data(), packed.data()));
    EXPECT_LE(test::relative_distance(packed, expected), kRoundOff);
  }
  for (int k = 0; k < 2 * n; ++k) z[k * kLanes + 1] = std::nan("");
  EXPECT_FALSE(
      packed_jacobian<kLanes>(system, t.data(), z.data(), weights.data(), jacobian.data()));
}

// By multipliers and Jets, as a scene without hand-written parts goes.
TEST(PackedRateOfMultipliers, AgreesWithTheRateLaneByLane) {
  using Plain = test::WithoutFrame<scenes::Vehicle>;
  const VelocityConstraints<Plain> system({test::uneven<scenes::Vehicle>()});
  for (unsigned seed = 1; seed < 20; ++seed) {
    EXPECT_LE((defect<8, pack_lane::Widest<8>::type>(system, seed)), kRoundOff);
  }
}

// One bad lane fails them all; the step then asks one by one, and says why or goes on.
TEST(PackedRateFailure, OneLaneIsEnough) {
  const VelocityConstraints<scenes::Vehicle> system(scenes::Vehicle{});
  std::array<double, 8> t{};
  std::array<double, 64> z;
  std::array<double, 16> y;
  std::array<double, 64> z_dot;
  for (int lane = 0; lane < 8; ++lane) {
    z.fill(0.5);
    EXPECT_TRUE(packed_rate<8>(system, t.data(), z.data(), y.data(), z_dot.data()));
    z[3 * 8 + lane] = std::nan("");
    EXPECT_FALSE(packed_rate<8>(system, t.data(), z.data(), y.data(), z_dot.data()));
  }
}

// sin() of packs ends at 1e6; a heading beyond is reduced by plain rates.
TEST(PackedRateFailure, FarAnglesAreLeftToPlainRates) {
  const VelocityConstraints<scenes::Vehicle> system(scenes::Vehicle{});
  const Vector<double, 4> p(1, 0.5, 0.2, 0.3);
  constexpr double kFar = 2e6;
  Gauss<VelocityConstraints<scenes::Vehicle>, 8> near_step(system);
  Gauss<VelocityConstraints<scenes::Vehicle>, 8> far_step(system);
  auto near = make_state<double, 4>(Vector<double, 4>(0, 0, std::remainder(kFar, 2 * M_PI), 0), p);
  near.value[3] = near.value[2] + 0.25;
  auto far = make_state<double, 4>(Vector<double, 4>(0, 0, kFar, kFar + 0.25), p);
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(near_step.step(0, 0.1, near).status, StepStatus::kOk);
    ASSERT_EQ(far_step.step(0, 0.1, far).status, StepStatus::kOk);
  }
  // Angles of 2e6 are known to 2e6 eps.
  EXPECT_NEAR(near.value[0], far.value[0], 100 * kFar * kEps);
  EXPECT_NEAR(near.value[1], far.value[1], 100 * kFar * kEps);
}

}  // namespace
}  // namespace carnot::packed_rate_test
