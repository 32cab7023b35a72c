// The right-hand sides by hand are those of the scenes, and the adaptive DOP853 is one.
#include "benchmark/benchmark_rates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "benchmark/benchmark_dop853.h"
#include "benchmark/benchmark_reference.h"
#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/system/phase_space.h"
#include "carnot/system/system_of.h"

namespace carnot::apps::benchmark_rates_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(SineCosine, IsRightToAnUlpOfOne) {
  constexpr double kUlps = 1;  // 0.76 were seen
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-8, 7);
  std::uniform_int_distribution<int> sign(0, 1);
  for (int i = 0; i < 100000; ++i) {
    const double x = (sign(random) != 0 ? 1 : -1) * std::pow(10, exponent(random));
    const SineCosine found = sine_cosine(x);
    EXPECT_NEAR(
        found.sine, static_cast<double>(std::sin(static_cast<long double>(x))), kUlps * kEps)
        << x;
    EXPECT_NEAR(
        found.cosine, static_cast<double>(std::cos(static_cast<long double>(x))), kUlps * kEps)
        << x;
  }
  EXPECT_EQ(sine_cosine(0).sine, 0);
  EXPECT_EQ(sine_cosine(0).cosine, 1);
  EXPECT_TRUE(std::isnan(sine_cosine(NAN).sine));
}

template <class Scene, class ByHand>
void expect_same_rate() {
  constexpr int n = Scene::kDof;
  static_assert(ByHand::kSize == 2 * n);
  constexpr double kUlps =
      8;  // of the largest component; a dozen roundings, some of them amplified
  const auto system = make_system(Scene{});
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> some(-3, 3);
  for (int i = 0; i < 1000; ++i) {
    Vector<double, 2 * n> z;
    for (int k = 0; k < 2 * n; ++k) z[k] = some(random);
    Vector<double, decltype(system)::kAlgebraic> y = decltype(y)::Zero();
    Vector<double, 2 * n> expected;
    Vector<double, 2 * n> found;
    ASSERT_EQ(phase_rate(system, 0.0, z, y, expected), RateStatus::kOk);
    ByHand{}(z.data(), found.data());
    const double scale = 1 + z.squaredNorm();
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kUlps * kEps * scale) << z.transpose();
  }
}

TEST(RatesByHand, AreThoseOfTheScenes) {
  expect_same_rate<scenes::Vehicle, VehicleRate>();
  expect_same_rate<scenes::VehicleCosine, VehicleCosineRate>();
  expect_same_rate<scenes::Heisenberg, HeisenbergRate>();
}

TEST(RatesByHand, AreFiniteAtTheTopOfThePotential) {
  const double z[8] = {0.5, 0, 0, 0.1, 1, 0, 0, 0};  // the midpoint is at the origin
  double f[8];
  VehicleCosineRate{}(z, f);
  double of_vehicle[8];
  VehicleRate{}(z, of_vehicle);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(f[i], of_vehicle[i], kEps);
}

// The coefficients of the compiler are those of the tableau.
TEST(AdaptiveDop853, HasTheCoefficientsOfTheTableau) {
  const Tableau<double> tableau = dop853_tableau<double>();
  const auto& b = dop853::kA[dop853::kStages];
  for (int i = 0; i < dop853::kStages; ++i) {
    EXPECT_NEAR(b[i], tableau.b[i], kEps * std::abs(tableau.b[i]));
    double sum = 0;
    double size = 1;
    for (int j = 0; j < dop853::kStages; ++j) {
      sum += dop853::kA[i][j];
      size = std::max(size, std::abs(dop853::kA[i][j]));
    }
    EXPECT_NEAR(sum, tableau.c[i], 4 * kEps * size) << i;
  }
  // Both embedded methods integrate constants.
  for (const auto& error : {dop853::kError5, dop853::kError3}) {
    double sum = 0;
    for (const double weight : error) sum += weight;
    EXPECT_NEAR(sum, 0, 8 * kEps);
  }
}

struct Trip {
  Dop853Report report;
  double error = 0;
};

Trip run_heisenberg(const BenchmarkReference& reference, double tolerance) {
  const BenchmarkTrajectory& trajectory = benchmark_trajectories()[2];
  std::vector<double> z = benchmark_start<double>(trajectory);
  const Dop853Report report =
      AdaptiveDop853<HeisenbergRate>({}, tolerance).run(trajectory.duration, z.data());
  return {report, reference.error(z.data())};
}

// Where nothing is rejected and round-off is far, the error of a step is the tolerance: so the
// number of steps grows like tolerance^(-1/8), and the error falls with it at least like order 8.
TEST(AdaptiveDop853, ReachesItsToleranceWithOrderEight) {
  constexpr double kAccumulated = 1000;  // the errors of so many steps add up
  const BenchmarkReference reference = compute_reference(benchmark_trajectories()[2], {});
  const Trip coarse = run_heisenberg(reference, 1e-9);
  const Trip fine = run_heisenberg(reference, 1e-12);
  for (const Trip& run : {coarse, fine}) {
    ASSERT_TRUE(run.report.completed);
    EXPECT_EQ(run.report.evaluations, 2 + 12 * run.report.steps - 1 + 11 * run.report.rejected);
  }
  EXPECT_LT(coarse.error, kAccumulated * 1e-9);
  EXPECT_LT(fine.error, kAccumulated * 1e-12);
  const double steps =
      std::log(static_cast<double>(fine.report.steps) / static_cast<double>(coarse.report.steps));
  EXPECT_NEAR(steps, std::log(1e3) / 8, 0.05 * steps);
  const double order = std::log(coarse.error / fine.error) / steps;
  EXPECT_GT(order, 7.5);
  EXPECT_LT(order, 10.5);  // errors of the phase partly cancel
}

// z' = z^2 from 1: infinite at t = 1.
struct Explosion {
  static constexpr int kSize = 1;
  void operator()(const double* z, double* f) const { f[0] = z[0] * z[0]; }
};

TEST(AdaptiveDop853, SaysWhenItCannot) {
  double z = 1;
  const Dop853Report report = AdaptiveDop853<Explosion>({}, 1e-8).run(2, &z);
  EXPECT_FALSE(report.completed);
  EXPECT_TRUE(std::isfinite(z));
}

}  // namespace
}  // namespace carnot::apps::benchmark_rates_test
