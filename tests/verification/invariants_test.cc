// What Gauss methods keep: linear and quadratic invariants and the constraints to round-off, the
// energy without drift.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/flow/flow.h"
#include "carnot/flow/monitor.h"
#include "carnot/numerics/line_fit.h"
#include "carnot/step/gauss.h"
#include "testing/runs.h"

namespace carnot::invariants_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

template <class Scene>
class InvariantsTest : public ::testing::Test {
 protected:
  static constexpr int kDof = Scene::kDof;
  using System = VelocityConstraints<Scene>;
  const System system_{test::uneven<Scene>()};
  test::Generator generator_{1};

  // x p_y - y p_x and the momenta of all angles: planar rotations are a symmetry of every scene.
  static double angular_momentum(const Vector<double, 2 * kDof>& z) {
    double sum = z[0] * z[kDof + 1] - z[1] * z[kDof];
    if constexpr (!std::is_same_v<Scene, scenes::Heisenberg> &&
                  !std::is_same_v<Scene, scenes::HeisenbergGroup>) {
      for (int i = 2; i < kDof; ++i) sum += z[kDof + i];
    }
    return sum;
  }
};
TYPED_TEST_SUITE(InvariantsTest, test::Scenes, test::SceneNames);

// Products of two coordinates, each rounded twice at every step: a random walk, four standard
// deviations of it.
TYPED_TEST(InvariantsTest, AngularMomentumIsKeptToRoundOff) {
  constexpr int n = TypeParam::kDof;
  constexpr long kSteps = 1000;
  for (int sample = 0; sample < 5; ++sample) {
    Gauss<typename TestFixture::System, 3> method(this->system_);
    auto z = test::random_state<n>(this->generator_);
    const double before = TestFixture::angular_momentum(z.value);
    double worst = 0;
    double product = 10;
    const auto watch = [&](long, const auto&, const auto& node) {
      worst = std::max(worst, std::abs(TestFixture::angular_momentum(node.value) - before));
      const double q = node.value.template head<n>().cwiseAbs().maxCoeff();
      const double p = node.value.template tail<n>().cwiseAbs().maxCoeff();
      product = std::max(product, q * p);
      return true;
    };
    ASSERT_TRUE(flow(method, StepPlan::equal(0, 50, kSteps), z, watch).completed());
    EXPECT_LE(worst, 4 * std::sqrt(2.0 * kSteps) * product * kEps);
  }
}

// p_x and p_y of the plane scenes, p_z of the Heisenberg problems: p' = 0 exactly.
TYPED_TEST(InvariantsTest, MomentaOfCyclicCoordinatesAreKeptBitForBit) {
  constexpr int n = TypeParam::kDof;
  std::vector<int> cyclic;
  if (std::is_same_v<TypeParam, scenes::Vehicle>) cyclic = {0, 1};
  if (std::is_same_v<TypeParam, scenes::Unicycle>) cyclic = {0, 1};
  if (std::is_same_v<TypeParam, scenes::Heisenberg>) cyclic = {2};
  if (std::is_same_v<TypeParam, scenes::HeisenbergGroup>) cyclic = {2};
  Gauss<typename TestFixture::System, 3> method(this->system_);
  const auto start = test::random_state<n>(this->generator_);
  auto z = start;
  ASSERT_TRUE(flow(method, StepPlan::equal(0, 10, 100), z).completed());
  for (const int i : cyclic) EXPECT_EQ(z.value[n + i], start.value[n + i]);
}

// g(q, q') = 0 at every stage and node, whatever the step.
TYPED_TEST(InvariantsTest, ConstraintsHoldAtStagesAndNodes) {
  constexpr int n = TypeParam::kDof;
  constexpr double kTolerance = 32 * kEps;  // a few products of numbers up to 10
  for (const long steps : {20L, 200L}) {
    Gauss<typename TestFixture::System, 3> method(this->system_);
    auto z = test::random_state<n>(this->generator_);
    Monitor<Gauss<typename TestFixture::System, 3>> audit(this->system_, 0, method, z);
    const StepPlan plan = StepPlan::equal(0, 10, steps);
    const auto watch = [&](long i, const auto& step, const auto& node) {
      audit(plan.time(i + 1), step, node);
      return true;
    };
    ASSERT_TRUE(flow(method, plan, z, watch).completed());
    EXPECT_LE(audit.constraint_error(), kTolerance);
  }
}

// Over 1e5 steps the energy error of a symplectic method stays bounded and forgets the time.
template <class Scene>
void expect_no_energy_drift(const Scene& scene, const State<double, Scene::kDof>& start, double h) {
  using System = VelocityConstraints<Scene>;
  constexpr long kSteps = 100000;
  const System system(scene);
  const auto energy = [&](const auto& z) {
    Vector<double, System::kAlgebraic> y;
    Rate<double, System::kDof> rate;
    const Vector<double, System::kDof> q = z.value.template head<System::kDof>();
    const Vector<double, System::kDof> p = z.value.template tail<System::kDof>();
    EXPECT_EQ(system.rate(0.0, q, p, y, rate), RateStatus::kOk);
    return system.hamiltonian(0.0, q, p, y);
  };
  Gauss<System, 2> method(system);
  auto z = start;
  const double initial = energy(z);
  std::vector<double> times;
  std::vector<double> errors;
  const StepPlan plan = StepPlan::of_length(0, h * kSteps, h);
  const auto watch = [&](long i, const auto&, const auto& node) {
    times.push_back(plan.time(i + 1));
    errors.push_back(energy(node) - initial);
    return true;
  };
  ASSERT_TRUE(flow(method, plan, z, watch).completed());
  // The largest error is reached in the first hundredth of the run, up to a quarter.
  double early = 0;
  double all = 0;
  for (long i = 0; i < kSteps; ++i) {
    const double error = std::abs(errors[static_cast<std::size_t>(i)]);
    if (i < kSteps / 100) early = std::max(early, error);
    all = std::max(all, error);
  }
  EXPECT_GT(early, 1e4 * kEps) << "the step is too small to show anything";
  EXPECT_LE(all, 1.25 * early);
  const LineFit fit = fit_line(times, errors);
  EXPECT_LT(std::abs(fit.correlation), 0.02);
  EXPECT_LT(std::abs(fit.slope) * plan.end, 0.05 * all);
}

TEST(EnergyTest, HeisenbergDoesNotDrift) {
  expect_no_energy_drift(
      scenes::Heisenberg{}, make_state<double, 3>({0, 0, 0}, {0.1, 0.3, 1}), 0.3);
}
TEST(EnergyTest, VehicleDoesNotDrift) {
  // p_x = p_y = 0: the steering angle swings, so the orbit comes back. (With other p_x, p_y the
  // vehicle drives away, p_theta grows with the distance, and no bound can hold.)
  expect_no_energy_drift(
      scenes::Vehicle{}, make_state<double, 4>({0, 0, 0, 0.5}, {0, 0, 1, 0.3}), 0.2);
}

}  // namespace
}  // namespace carnot::invariants_test
