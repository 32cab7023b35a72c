// The compiled kernels, which reach a scene through function pointers, against those that know it.
#include "carnot/flow/make_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "carnot/make_inlined_dynamics.h"
#include "carnot/scenes/kapitza_pendulum.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/step/gauss.h"
#include "testing/distance.h"

namespace carnot::make_kernel_test {
namespace {

using test::largest_change;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// Two runs that differ in the order of their sums only.
struct Pair {
  Dynamics compiled;
  Dynamics direct;
  std::vector<double> start;
  double duration;
};

// gauss16 in a kernel that knows its scene.
template <class Scene>
Dynamics make_direct(const Scene& scene) {
  using System = decltype(make_system(scene));
  using Method = kernel::Direct<RungeKutta<System, 8>>;
  Dynamics dynamics = make_dynamics(scene);
  const auto periods = dynamics_calls::periods_of(dynamics.info);
  dynamics.kernel = kernel::kernel_of(
      Method{fixed_gauss_tableau<double, 8>(), kernel::winding_of<Scene::kDof>(periods)});
  return dynamics;
}

Pair vehicle() {
  const scenes::Vehicle scene;
  return {make_dynamics(scene), make_direct(scene), {1, 0.5, 0.3, 0.8, 0.7, 0.7, 0.5, 0.2}, 10};
}

// H depends on time, and H_y = 0 is solved by Newton's method.
Pair kapitza_pendulum() {
  const scenes::KapitzaPendulum scene;
  return {make_dynamics(scene), make_direct(scene), {0.3, 0.1}, 1};
}

// A unicycle that does not say that its heading is an angle.
struct FarHeading : scenes::Unicycle {
  [[nodiscard]] SceneInfo info() const = delete;
};

class MakeKernel : public ::testing::TestWithParam<Pair (*)()> {
 protected:
  const Pair pair_ = GetParam()();
  const StepPlan plan_ = StepPlan::equal(0.1, pair_.duration, 64);
};

// Of sixty steps with rounding errors of an ulp or so, on motions that enlarge them by ten or so.
constexpr double kRoundOff = 2000 * kEps;

TEST_P(MakeKernel, FlowsAgree) {
  std::vector<double> a = pair_.start;
  std::vector<double> b = pair_.start;
  ASSERT_TRUE(pair_.compiled.flow(plan_, a).completed());
  ASSERT_TRUE(pair_.direct.flow(plan_, b).completed());
  EXPECT_LE(largest_change(a, b), kRoundOff);
}

TEST_P(MakeKernel, TangentsAgree) {
  const std::size_t size = pair_.start.size();
  std::vector<double> a = pair_.start;
  std::vector<double> b = pair_.start;
  std::vector<double> ma(size * size);
  std::vector<double> mb(size * size);
  ASSERT_TRUE(pair_.compiled.tangent_flow(plan_, a, ma).completed());
  ASSERT_TRUE(pair_.direct.tangent_flow(plan_, b, mb).completed());
  double largest = 1;
  for (const double x : mb) largest = std::max(largest, std::abs(x));
  EXPECT_LE(largest_change(ma, mb), kRoundOff * largest);
}

// The derivatives of the steps, one after the other, are that of the flow.
TEST_P(MakeKernel, TangentsOfStepsMakeThatOfTheFlow) {
  const auto size = static_cast<int>(pair_.start.size());
  const auto square = static_cast<std::size_t>(size) * size;
  const auto steps = static_cast<std::size_t>(plan_.count);
  for (const Dynamics* dynamics : {&pair_.compiled, &pair_.direct}) {
    std::vector<double> end = pair_.start;
    std::vector<double> whole(square);
    ASSERT_TRUE(dynamics->tangent_flow(plan_, end, whole).completed());
    std::vector<double> z = pair_.start;
    std::vector<double> nodes(steps * pair_.start.size());
    std::vector<double> tangents(steps * square);
    ASSERT_TRUE(dynamics->tangent_steps(plan_, z, nodes, tangents).completed());
    EXPECT_EQ(z, end);
    EXPECT_EQ(std::vector<double>(nodes.end() - size, nodes.end()), end);
    std::vector<double> product(square, 0.0);
    for (int r = 0; r < size; ++r) product[r * size + r] = 1;
    for (std::size_t i = 0; i < steps; ++i) {
      std::vector<double> next(square, 0.0);
      for (int r = 0; r < size; ++r) {
        for (int k = 0; k < size; ++k) {
          const double entry = tangents[i * square + r * size + k];
          for (int c = 0; c < size; ++c) next[r * size + c] += entry * product[k * size + c];
        }
      }
      product = next;
    }
    double largest = 1;
    for (const double x : whole) largest = std::max(largest, std::abs(x));
    EXPECT_LE(largest_change(product, whole), kRoundOff * largest);
  }
}

TEST_P(MakeKernel, MonitorsAgree) {
  std::vector<double> a = pair_.start;
  std::vector<double> b = pair_.start;
  MonitorOptions options;
  options.samples = 5;
  const FlowSummary one = pair_.compiled.monitored_flow(plan_, a, options);
  const FlowSummary other = pair_.direct.monitored_flow(plan_, b, options);
  ASSERT_TRUE(one.completed());
  ASSERT_TRUE(other.completed());
  EXPECT_NEAR(one.action, other.action, kRoundOff * (1 + std::abs(other.action)));
  EXPECT_EQ(std::isnan(one.length), std::isnan(other.length));
  EXPECT_NEAR(one.energy_balance, other.energy_balance, kRoundOff);
  EXPECT_NEAR(one.energy_drift, other.energy_drift, kRoundOff);
  EXPECT_NEAR(one.constraint_error, other.constraint_error, kRoundOff);
  ASSERT_EQ(one.trajectory.lambda.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_EQ(one.trajectory.lambda[i].size(),
              static_cast<std::size_t>(pair_.compiled.multipliers));
    EXPECT_LE(largest_change(one.trajectory.q[i], other.trajectory.q[i]), kRoundOff);
    EXPECT_LE(largest_change(one.trajectory.lambda[i], other.trajectory.lambda[i]), 10 * kRoundOff);
  }
}

// H changes by the integral of H_t, at samples between the nodes, too.
TEST_P(MakeKernel, SamplesTellTheWork) {
  std::vector<double> z = pair_.start;
  MonitorOptions options;
  options.samples = 37;
  const FlowSummary summary = pair_.compiled.monitored_flow(plan_, z, options);
  ASSERT_TRUE(summary.completed());
  const Trajectory& samples = summary.trajectory;
  ASSERT_EQ(samples.work.size(), samples.t.size());
  EXPECT_EQ(samples.work.front(), 0);
  EXPECT_EQ(samples.work.back(), summary.work);
  EXPECT_EQ(summary.work == 0, pair_.compiled.autonomous);
  for (std::size_t i = 0; i < samples.t.size(); ++i) {
    const double change = samples.hamiltonian[i] - samples.hamiltonian.front();
    EXPECT_NEAR(change, samples.work[i], kRoundOff) << samples.t[i];
  }
}

TEST_P(MakeKernel, AutomaticFlowsReachTheTolerance) {
  constexpr double kTolerance = 1e-9;
  std::vector<double> exact = pair_.start;
  const StepPlan fine = StepPlan::equal(0.1, pair_.duration, 512);
  ASSERT_TRUE(pair_.direct.flow(fine, exact).completed());
  std::vector<double> z = pair_.start;
  ASSERT_TRUE(pair_.compiled.has_automatic_flow());
  const AutomaticFlow run = pair_.compiled.automatic_flow(0.1, pair_.duration, kTolerance, z);
  if (run.reached) {  // else it says so, and z is the start
    EXPECT_LE(largest_change(z, exact), kTolerance);
  } else {
    EXPECT_EQ(z, pair_.start);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, MakeKernel, ::testing::Values(vehicle, kapitza_pendulum));

TEST(MakeKernelFailure, SaysWhyARateFails) {
  const Dynamics dynamics = make_dynamics(scenes::Vehicle{});
  std::vector<double> z{0, 0, 0, 0, NAN, 0, 0, 0};
  const std::vector<double> start = z;
  const FlowReport report = dynamics.flow(StepPlan::equal(0, 1, 4), z);
  EXPECT_FALSE(report.completed());
  EXPECT_EQ(report.last.rate, RateStatus::kNotFinite);
}

// Rates go on where an angle without a period is far away; their derivatives do not.
TEST(MakeKernelFailure, SaysThatAnAngleIsTooFarForTangents) {
  const Dynamics dynamics = make_dynamics(FarHeading{});
  const std::vector<double> start{0, 0, 2e6, 1, 0.5, 0.2};
  std::vector<double> z = start;
  EXPECT_TRUE(dynamics.flow(StepPlan::equal(0, 1, 4), z).completed());
  z = start;
  std::vector<double> m(36);
  const FlowReport report = dynamics.tangent_flow(StepPlan::equal(0, 1, 4), z, m);
  EXPECT_FALSE(report.completed());
  EXPECT_EQ(report.last.rate, RateStatus::kFarAngle);
}

// Whole turns of the headings, some hundred thousand, change nothing but the headings.
TEST(MakeKernelTangent, TakesTurnsOffAngles) {
  constexpr long double kTurn = 2 * std::numbers::pi_v<long double>;
  const Dynamics dynamics = make_dynamics(scenes::Vehicle{});
  const StepPlan plan = StepPlan::equal(0, 1, 16);
  const std::vector<double> far{0, 0, 2e6, -3e6, 1, 0.5, 0.2, 0.1};
  std::vector<double> near = far;
  for (int j : {2, 3})
    near[j] = static_cast<double>(std::remainder(static_cast<long double>(far[j]), kTurn));
  std::vector<double> at_far = far;
  std::vector<double> at_near = near;
  std::vector<double> m_far(64);
  std::vector<double> m_near(64);
  ASSERT_TRUE(dynamics.tangent_flow(plan, at_far, m_far).completed());
  ASSERT_TRUE(dynamics.tangent_flow(plan, at_near, m_near).completed());
  double largest = 1;
  for (const double x : m_near) largest = std::max(largest, std::abs(x));
  EXPECT_LE(largest_change(m_far, m_near), kRoundOff * largest);
  for (int j = 0; j < 8; ++j) {
    EXPECT_NEAR(at_far[j] - far[j], at_near[j] - near[j], kRoundOff + kEps * std::abs(far[j]));
  }
  // And gives them back at each node.
  std::vector<double> z = far;
  std::vector<double> nodes(16 * 8);
  std::vector<double> tangents(16 * 64);
  ASSERT_TRUE(dynamics.tangent_steps(plan, z, nodes, tangents).completed());
  for (int i = 0; i < 16; ++i) {
    for (int j : {2, 3}) EXPECT_NEAR(nodes[i * 8 + j], far[j], 10) << i;
  }
  EXPECT_EQ(std::vector<double>(nodes.end() - 8, nodes.end()), at_far);
}

TEST(MakeKernelBatch, AdvancesManyAsOne) {
  const Pair pair = vehicle();
  constexpr int kCount = 11;
  constexpr double kTolerance = 1e-10;
  ASSERT_TRUE(pair.compiled.has_adaptive_batch());
  std::vector<double> z;
  for (int i = 0; i < kCount; ++i) {
    z.insert(z.end(), pair.start.begin(), pair.start.end());
    z[8 * i + 4] += 0.01 * i;
  }
  const std::vector<double> starts = z;
  const BatchReport report =
      pair.compiled.adaptive_batch(0, pair.duration, kTolerance, kCount, z, 2);
  EXPECT_EQ(report.completed, kCount);
  for (int i = 0; i < kCount; ++i) {
    std::vector<double> one(starts.begin() + 8 * i, starts.begin() + 8 * i + 8);
    const StepPlan plan = StepPlan::equal(0, pair.duration, 64);
    ASSERT_TRUE(pair.direct.flow(plan, one).completed());
    const std::vector<double> of_batch(z.begin() + 8 * i, z.begin() + 8 * i + 8);
    EXPECT_LE(largest_change(of_batch, one), 1e4 * kTolerance);  // local errors add up and grow
  }
}

// More coordinates than any compiled kernel has: q_i' = q_i+1 and, for the last one, a control.
struct Chain {
  static constexpr int kDof = kMostCompiled + 1;
  static constexpr int kControls = 1;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, 1> frame(const Vector<T, kDof>& /*q*/) const {
    Matrix<T, kDof, 1> f = Matrix<T, kDof, 1>::Constant(constant<T>(0));
    f(kDof - 1, 0) = constant<T>(1);
    return f;
  }
  template <class T>
  [[nodiscard]] Vector<T, kDof> drift(const Vector<T, kDof>& q) const {
    Vector<T, kDof> f = Vector<T, kDof>::Constant(constant<T>(0));
    for (int i = 0; i + 1 < kDof; ++i) f[i] = q[i + 1];
    return f;
  }
};

TEST(MakeKernelSize, MoreCoordinatesHaveAKernelOfTheirOwn) {
  const Dynamics dynamics = make_inlined_dynamics(Chain{});
  std::vector<double> z(2 * Chain::kDof, 0.0);
  z.back() = 1;  // the control, constant
  ASSERT_TRUE(dynamics.flow(StepPlan::equal(0, 1, 2), z).completed());
  double exact = 1;  // t^k / k! at t = 1, from the end of the chain
  for (int i = Chain::kDof - 1; i >= 0; --i) {
    exact /= Chain::kDof - i;
    EXPECT_NEAR(z[i], exact, 16 * kEps);
  }
}

}  // namespace
}  // namespace carnot::make_kernel_test
