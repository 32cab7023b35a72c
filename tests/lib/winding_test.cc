// Turns taken off angles: nothing is lost, and long runs keep H better.
#include "carnot/flow/winding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/make_dynamics.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"

namespace carnot::winding_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEps = std::numeric_limits<double>::epsilon();
using Wide = long double;

State<double, 2> angle(double value) {
  return make_state<double, 2>(Vector<double, 2>(value, value), Vector<double, 2>(value, 1));
}

Wide of(const State<double, 2>& z, int i) {
  return static_cast<Wide>(z.value[i]) + static_cast<Wide>(z.compensation[i]);
}

TEST(Winding, TakesOffWholeTurnsOfAnglesAlone) {
  const Wide turn = 2 * std::numbers::pi_v<Wide>;
  for (const double start : {4.8, -5.0, 7.0, 40.0, -1e3, 1e6}) {
    Winding<2> winding({2 * kPi, 0});
    auto z = angle(start);
    winding.fold(z);
    EXPECT_LE(std::abs(z.value[0]), kPi * (1 + kEps));
    // To more digits than double has: the sine of the small angle is that of the large one.
    const Wide turns = std::round((start - of(z, 0)) / turn);
    EXPECT_LE(std::abs(of(z, 0) + turns * turn - start), 1e-2 * kEps * std::abs(start));
    EXPECT_EQ(z.value[1], start);
    EXPECT_EQ(z.value[2], start);
    const auto back = winding.unfolded(z);
    EXPECT_EQ(back.value, angle(start).value);
  }
}

TEST(Winding, LeavesSmallAnglesAlone) {
  for (const double start : {0.0, 3.2, -4.7}) {
    Winding<2> winding({2 * kPi, kPi / 2});
    auto z = angle(start);
    z.value[1] = 1;
    const auto before = z;
    winding.fold(z);
    EXPECT_EQ(z.value, before.value);
    EXPECT_EQ(z.compensation, before.compensation);
    EXPECT_EQ(winding.unfolded(z).value, before.value);
  }
}

TEST(Winding, CountsOnOverManyTurns) {
  constexpr int kSteps = 100000;
  constexpr double kStep = 0.3;
  Winding<2> winding({2 * kPi, kPi});
  auto z = angle(0);
  const Vector<double, 4> step(kStep, -kStep, kStep, 0);
  for (int i = 0; i < kSteps; ++i) {
    z.add(step);
    winding.fold(z);
  }
  const auto end = winding.unfolded(z);
  // Each turn is known to eps^2 of itself.
  EXPECT_NEAR(end.value[0], kSteps * kStep, 2 * kEps * kSteps * kStep);
  EXPECT_NEAR(end.value[1], -kSteps * kStep, 2 * kEps * kSteps * kStep);
}

// The vehicle going round and round: H as good after 1e4 turns as the round-off of as many steps,
// and the angle comes out with all its turns.
TEST(Winding, KeepsTheEnergyOfATurningVehicle) {
  const Dynamics dynamics = make_dynamics(scenes::Vehicle{});
  const std::array<double, 8> start = {0, 0, 0.7, 1.2, 0.3, 0, 0.1, 1};
  constexpr long kSteps = 50000;
  constexpr double kStep = 0.2;
  const auto plan = StepPlan::of_length(0, kStep * kSteps, kStep);
  auto z = start;
  auto audited = start;
  ASSERT_TRUE(dynamics.flow(plan, z).completed());
  const FlowSummary summary = dynamics.monitored_flow(plan, audited, {2, {}, {}});
  ASSERT_TRUE(summary.completed());
  EXPECT_EQ(z, audited);
  EXPECT_EQ(summary.trajectory.q.back()[3], z[3]);
  EXPECT_GT(std::abs(z[3]), 1000 * kPi);
  // A random walk of round-off, with room: 4 sqrt(n) eps.
  EXPECT_LE(summary.energy_drift, 4 * std::sqrt(kSteps) * kEps);
}

}  // namespace
}  // namespace carnot::winding_test
