// Brouwer's law: round-off makes H a random walk, so that its error grows like the square root of
// the number of steps, when nothing in a step is rounded the same way every time.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/flow/winding.h"
#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/step/gauss.h"
#include "carnot/system/velocity_constraints.h"
#include "catalogue/scene_choice.h"

namespace carnot::round_off_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kStep = 0.2;

template <int n>
using Start = State<double, n>;

Start<4> near(const scenes::Vehicle& /*scene*/, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> some(-0.1, 0.1);
  return make_state<double, 4>(Vector<double, 4>(0, 0, 1.2 + some(generator), 1.2),
                               Vector<double, 4>(1, 0, 0.1 + some(generator), 0.1));
}
Start<3> near(const scenes::Heisenberg& /*scene*/, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> some(-0.1, 0.1);
  return make_state<double, 3>(
      Vector<double, 3>::Zero(),
      Vector<double, 3>(0.1, 0.3 + some(generator) / 10, 1 + some(generator)));
}

Winding<4> angles(const scenes::Vehicle& /*scene*/) { return Winding<4>({0, 0, kTurn, kTurn}); }
Winding<3> angles(const scenes::Heisenberg& /*scene*/) { return {}; }

// H of the sum of value and compensation.
template <class System>
long double energy(const System& system, const State<double, System::kDof>& z) {
  using Wide = long double;
  constexpr int n = System::kDof;
  const Vector<Wide, 2 * n> sum =
      z.value.template cast<Wide>() + z.compensation.template cast<Wide>();
  const Vector<Wide, n> q = sum.template head<n>();
  const Vector<Wide, n> p = sum.template tail<n>();
  Vector<Wide, System::kAlgebraic> y;
  Rate<Wide, n> rate;
  EXPECT_EQ(system.rate(Wide(0), q, p, y, rate), RateStatus::kOk);
  return system.hamiltonian(Wide(0), q, p, y);
}

double mean_square(const std::vector<double>& errors) {
  double squares = 0;
  for (const double error : errors) squares += error * error;
  return std::sqrt(squares / static_cast<double>(errors.size()));
}

// Root mean square of the largest |H - H0|/H0 over `steps` steps of the program's own flow.
template <class Scene>
double drift(const Scene& scene, long steps) {
  const Dynamics dynamics = apps::find_scene(scene.info().name).make({}, "gauss16");
  const VelocityConstraints<Scene> system(scene);
  std::vector<double> errors;
  for (int i = 0; i < 4; ++i) {
    std::mt19937_64 generator(i);
    auto z = near(scene, generator);
    const auto start = static_cast<double>(energy(system, z));
    const auto plan = StepPlan::of_length(0, kStep * static_cast<double>(steps), kStep);
    const FlowSummary summary = dynamics.monitored_flow(plan, span_of(z.value), {});
    if (!summary.completed()) return INFINITY;
    errors.push_back(summary.energy_drift / std::abs(start));
  }
  return mean_square(errors);
}

// That of (H - H0)/H0 at the end, step by step, with or without what the last rounding left.
template <class Scene>
double plain_drift(const Scene& scene, long steps, bool compensated) {
  using System = VelocityConstraints<Scene>;
  const System system(scene);
  std::vector<double> errors;
  for (int i = 0; i < 4; ++i) {
    std::mt19937_64 generator(i);
    Gauss<System, 8> gauss(system);
    auto winding = angles(scene);
    auto z = near(scene, generator);
    const long double start = energy(system, z);
    for (long step = 0; step < steps; ++step) {
      if (gauss.step(0, kStep, z).status != StepStatus::kOk) return INFINITY;
      if (!compensated) z.compensation.setZero();
      winding.fold(z);
    }
    errors.push_back(static_cast<double>((energy(system, z) - start) / start));
  }
  return mean_square(errors);
}

template <class Scene>
class RoundOffTest : public ::testing::Test {
 protected:
  const Scene scene_{};
};
using Scenes = ::testing::Types<scenes::Heisenberg, scenes::Vehicle>;
TYPED_TEST_SUITE(RoundOffTest, Scenes);

// A step adds a fifth of eps or less; a systematic part of eps/1000 would show at the end.
TYPED_TEST(RoundOffTest, EnergyErrorGrowsLikeTheRootOfTheSteps) {
  for (const long steps : {1000L, 30000L, 1000000L}) {
    EXPECT_LE(drift(this->scene_, steps), kEps * std::sqrt(steps)) << steps << " steps";
  }
}

TYPED_TEST(RoundOffTest, CompensationPays) {
  constexpr long kSteps = 50000;
  EXPECT_LE(plain_drift(this->scene_, kSteps, true), plain_drift(this->scene_, kSteps, false));
}

}  // namespace
}  // namespace carnot::round_off_test
