// Many trajectories at once against one by one.
#include "carnot/flow/batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "testing/order.h"
#include "testing/program_scenes.h"
#include "testing/runs.h"

namespace carnot::batch_test {
namespace {

using test::Generator;

std::vector<double> random_points(int n, int count, unsigned seed) {
  Generator generator(seed);
  std::vector<double> z;
  for (int i = 0; i < 2 * n * count; ++i) z.push_back(test::random_vector<1>(generator, 1)[0]);
  return z;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

// Gauss at round-off against the explicit method, for counts that fill packs and that do not.
TEST(Batch, TwoMethodsAgree) {
  const Dynamics dynamics = test::program_dynamics(scenes::VehicleCosine{}, "gauss16");
  for (const int count : {1, 7, 8, 9, 16, 25}) {
    auto exact = random_points(4, count, 3);
    auto fast = exact;
    const BatchReport gauss = dynamics.flow_batch(StepPlan::equal(0, 4, 60), count, exact);
    const BatchReport adaptive = dynamics.adaptive_batch(0, 4, 1e-11, count, fast);
    EXPECT_EQ(gauss.completed, count);
    EXPECT_EQ(adaptive.completed, count);
    EXPECT_EQ(gauss.failed + adaptive.failed, 0);
    EXPECT_GE(adaptive.evaluations, 12 * count);
    // The tolerance is that of a step.
    EXPECT_LE(difference(exact, fast), 1e-8);
  }
}

// The error follows the tolerance: a method of order 8 whose steps are set by an estimate of order
// 7, over six decades.
TEST(Batch, ErrorFollowsTheTolerance) {
  const Dynamics dynamics = test::program_dynamics(scenes::Vehicle{}, "gauss16");
  auto exact = random_points(4, 8, 4);
  const auto start = exact;
  (void)dynamics.flow_batch(StepPlan::equal(0, 5, 80), 8, exact);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    auto z = start;
    EXPECT_EQ(dynamics.adaptive_batch(0, 5, tolerance, 8, z).completed, 8);
    const double error = difference(exact, z);
    EXPECT_LE(error, 1000 * tolerance);
    EXPECT_LE(error, last / 10);
    last = error;
  }
}

TEST(Batch, BackwardsUndoesForwards) {
  const Dynamics dynamics = test::program_dynamics(scenes::Unicycle{}, "gauss16");
  const auto start = random_points(3, 8, 5);
  auto z = start;
  (void)dynamics.adaptive_batch(0, 3, 1e-12, 8, z);
  EXPECT_GE(difference(start, z), 0.1);
  (void)dynamics.adaptive_batch(3, -3, 1e-12, 8, z);
  EXPECT_LE(difference(start, z), 1e-9);
}

TEST(Batch, DoesNotDependOnTheThreads) {
  const Dynamics dynamics = test::program_dynamics(scenes::VehicleCosine{}, "gauss16");
  auto one = random_points(4, 37, 6);
  auto three = one;
  auto gauss_one = one;
  auto gauss_three = one;
  (void)dynamics.adaptive_batch(0, 3, 1e-9, 37, one, 1);
  (void)dynamics.adaptive_batch(0, 3, 1e-9, 37, three, 3);
  EXPECT_EQ(one, three);
  (void)dynamics.flow_batch(StepPlan::equal(0, 3, 20), 37, gauss_one, 1);
  (void)dynamics.flow_batch(StepPlan::equal(0, 3, 20), 37, gauss_three, 3);
  EXPECT_EQ(gauss_one, gauss_three);
}

// A trajectory that can't be followed becomes NaN, its neighbours are not touched.
TEST(Batch, OneFailureStaysOne) {
  const Dynamics dynamics = test::program_dynamics(scenes::VehicleCosine{}, "gauss16");
  const auto start = random_points(4, 11, 7);
  auto alone = start;
  for (int i = 0; i < 11; ++i) {
    (void)dynamics.adaptive_batch(0, 3, 1e-10, 1, std::span(alone).subspan(8 * i, 8), 1);
  }
  auto z = start;
  z[8 * 4 + 2] = std::nan("");
  const BatchReport report = dynamics.adaptive_batch(0, 3, 1e-10, 11, z, 2);
  EXPECT_EQ(report.completed, 10);
  EXPECT_EQ(report.failed, 1);
  for (int i = 0; i < 11; ++i) {
    for (int k = 0; k < 8; ++k) {
      if (i == 4) {
        EXPECT_TRUE(std::isnan(z[8 * i + k]));
      } else {
        // Those of its pack have gone alone, the others with common steps.
        EXPECT_NEAR(z[8 * i + k], alone[8 * i + k], 1e-7);
      }
    }
  }
  auto gauss = start;
  gauss[8 * 4 + 2] = std::nan("");
  const BatchReport by_plan = dynamics.flow_batch(StepPlan::equal(0, 3, 30), 11, gauss);
  EXPECT_EQ(by_plan.completed, 10);
  EXPECT_EQ(by_plan.failed, 1);
  EXPECT_TRUE(std::isnan(gauss[8 * 4]));
  EXPECT_FALSE(std::isnan(gauss[8 * 5]));
}

}  // namespace
}  // namespace carnot::batch_test
