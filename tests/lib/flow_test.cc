#include "carnot/flow/flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/step/gauss.h"
#include "testing/counting_system.h"
#include "testing/failing_scenes.h"
#include "testing/runs.h"

namespace carnot::flow_test {
namespace {

using Vehicle = VelocityConstraints<scenes::Vehicle>;
using Counting = test::CountingSystem<Vehicle>;
using Step = Gauss<Vehicle, 2>;

constexpr double kEps = std::numeric_limits<double>::epsilon();

// The laws of every plan: nodes from start to end, lengths that are the gaps between them.
void expect_consistent(const StepPlan& plan, double start, double duration) {
  const double size = std::abs(start) + std::abs(duration);
  ASSERT_GE(plan.count, 1);
  EXPECT_EQ(plan.time(0), start);
  EXPECT_EQ(plan.time(plan.count), plan.end);
  EXPECT_NEAR(plan.end, start + duration, kEps * size);
  for (long i = 0; i < plan.count; ++i) {
    EXPECT_NEAR(plan.time(i + 1) - plan.time(i), plan.length(i), 4 * kEps * size) << i;
    EXPECT_GT(plan.length(i) * duration, 0) << "steps go the way of the duration";
    EXPECT_LE(std::abs(plan.length(i)), std::abs(plan.step) * (1 + 4 * kEps));
  }
}

TEST(StepPlanTest, EqualSteps) {
  for (const double start : {0.0, -3.0, 10.0}) {
    for (const double duration : {1.0, 0.1, 1e4, -1.0, -0.7}) {
      for (const long count : {1L, 3L, 10L, 1000L}) {
        const StepPlan plan = StepPlan::equal(start, duration, count);
        expect_consistent(plan, start, duration);
        EXPECT_EQ(plan.count, count);
        EXPECT_EQ(plan.length(count - 1), plan.step);
      }
    }
  }
}

TEST(StepPlanTest, LengthThatDividesTheDuration) {
  for (const double sign : {1.0, -1.0}) {
    const StepPlan plan = StepPlan::of_length(0, sign * 1.0, sign * 0.1);  // 0.1 is not exact
    expect_consistent(plan, 0, sign);
    EXPECT_EQ(plan.count, 10);
    EXPECT_EQ(plan.length(9), plan.step);
  }
}

TEST(StepPlanTest, LengthThatDoesNotDivide) {
  for (const double sign : {1.0, -1.0}) {
    const StepPlan plan = StepPlan::of_length(2, sign * 1.0, sign * 0.3);
    expect_consistent(plan, 2, sign);
    EXPECT_EQ(plan.count, 4);
    EXPECT_EQ(plan.length(0), sign * 0.3);
    EXPECT_NEAR(plan.length(3), sign * 0.1, 4 * kEps);
  }
}

TEST(StepPlanTest, LengthOfTheWholeAndMore) {
  for (const double h : {1.0, 1.0000001, 1.4, 1.6, 100.0}) {
    for (const double sign : {1.0, -1.0}) {
      const StepPlan plan = StepPlan::of_length(0, sign, sign * h);
      expect_consistent(plan, 0, sign);
      EXPECT_EQ(plan.count, 1);
      EXPECT_EQ(plan.length(0), sign);
    }
  }
}

TEST(StepPlanTest, NodesAreNotAccumulated) {
  const StepPlan plan = StepPlan::of_length(0, 1e5, 0.1);
  EXPECT_EQ(plan.count, 1000000);
  EXPECT_EQ(plan.time(777777), 777777 * plan.step);
  EXPECT_EQ(plan.time(plan.count), 1e5);
}

class FlowTest : public ::testing::Test {
 protected:
  const Vehicle system_{test::uneven<scenes::Vehicle>()};
  test::Generator generator_{1};
  const State<double, 4> start_ = test::random_state<4>(generator_);
};

TEST_F(FlowTest, IsItsStepsOneByOne) {
  const StepPlan plan = StepPlan::of_length(0, 1, 0.15);
  Step one(system_);
  auto z = start_;
  const FlowReport report = flow(one, plan, z);
  EXPECT_TRUE(report.completed());
  EXPECT_EQ(report.steps, 7);
  EXPECT_EQ(report.time_reached, 1);
  EXPECT_EQ(report.reason(), "");
  Step other(system_);
  auto by_hand = start_;
  for (long i = 0; i < plan.count; ++i) {
    ASSERT_EQ(other.step(plan.time(i), plan.length(i), by_hand).status, StepStatus::kOk);
  }
  EXPECT_EQ(z.value, by_hand.value);
  EXPECT_EQ(z.compensation, by_hand.compensation);
}

TEST_F(FlowTest, CountsEveryRate) {
  const Counting counting(test::uneven<scenes::Vehicle>());
  Gauss<Counting, 2> step(counting);
  auto z = start_;
  const FlowReport report = flow(step, StepPlan::of_length(0, 1, 0.15), z);
  ASSERT_TRUE(report.completed());
  EXPECT_EQ(report.evaluations, counting.calls);
  EXPECT_EQ(report.newton_steps, 0);
}

TEST_F(FlowTest, ObserverSeesEveryNodeAndMayStop) {
  constexpr long kStopAfter = 4;
  const StepPlan plan = StepPlan::equal(0, 1, 10);
  Step step(system_);
  auto z = start_;
  std::vector<long> seen;
  const FlowReport report = flow(step, plan, z, [&](long i, const Step& done, const auto& node) {
    seen.push_back(i);
    EXPECT_EQ(node.value, z.value);
    EXPECT_EQ(done.last_step(), plan.length(i));
    EXPECT_NEAR(done.stage_time(0), plan.time(i) + done.tableau().c[0] * plan.step, kEps);
    return i + 1 < kStopAfter;
  });
  EXPECT_EQ(report.status, FlowStatus::kStopped);
  EXPECT_FALSE(report.completed());
  EXPECT_EQ(report.steps, kStopAfter);
  EXPECT_EQ(report.time_reached, plan.time(kStopAfter));
  EXPECT_EQ(seen, (std::vector<long>{0, 1, 2, 3}));
  EXPECT_FALSE(report.reason().empty());
  // The state is that of the node where it stopped.
  Step again(system_);
  auto part = start_;
  (void)flow(again, StepPlan::equal(0, plan.time(kStopAfter), kStopAfter), part);
  EXPECT_LE(test::relative_distance(z.value, part.value), 8 * kEps);
}

TEST_F(FlowTest, FailureLeavesTheLastGoodNode) {
  Counting failing(test::uneven<scenes::Vehicle>());
  Gauss<Counting, 2> step(failing);
  auto z = start_;
  auto last = start_;
  const StepPlan plan = StepPlan::equal(0, 1, 10);
  const FlowReport report = flow(step, plan, z, [&](long i, const auto&, const auto& node) {
    last = node;
    if (i == 4) {
      failing.fail_from = failing.calls + 1;
      failing.fail_to = std::numeric_limits<long>::max();
    }
    return true;
  });
  EXPECT_EQ(report.status, FlowStatus::kStepFailed);
  EXPECT_EQ(report.steps, 5);
  EXPECT_EQ(report.time_reached, plan.time(5));
  EXPECT_EQ(report.last.rate, RateStatus::kNotFinite);
  EXPECT_EQ(report.reason(), describe(RateStatus::kNotFinite));
  EXPECT_EQ(z.value, last.value);
  EXPECT_EQ(z.compensation, last.compensation);
}

// Escape to infinity in finite time: at half the critical time all is well, beyond it the run fails
// somewhere before, at a finite state.
TEST(FlowFailureTest, FiniteTimeEscape) {
  using System = VelocityConstraints<test::RunAway>;
  const System system{{}};
  const auto start = make_state<double, 1>(Vector<double, 1>(1), Vector<double, 1>(1));
  // t = integral dq / sqrt(1 - 2 + 2 q^4) from 1 is below 1.
  for (const long steps : {10L, 100L, 1000L}) {
    Gauss<System, 2> step(system);
    auto z = start;
    const FlowReport report = flow(step, StepPlan::equal(0, 2, steps), z);
    EXPECT_EQ(report.status, FlowStatus::kStepFailed) << steps << " steps";
    EXPECT_LT(report.time_reached, 2);
    EXPECT_TRUE(z.value.allFinite());
    EXPECT_FALSE(report.reason().empty());
  }
}

TEST_F(FlowTest, BackwardsUndoesForwards) {
  Step step(system_);
  auto z = start_;
  ASSERT_TRUE(flow(step, StepPlan::of_length(0, 1, 0.15), z).completed());
  // The short step comes first on the way back, so the grids differ: equal to order 4 only.
  constexpr double kMethodError = 1e-3;
  const FlowReport report = flow(step, StepPlan::of_length(1, -1, -0.15), z);
  ASSERT_TRUE(report.completed());
  EXPECT_EQ(report.time_reached, 0);
  EXPECT_LE(test::relative_distance(z.value, start_.value), kMethodError);
}

TEST_F(FlowTest, TangentFlowLeavesTheFlowAlone) {
  const StepPlan plan = StepPlan::of_length(0, 1, 0.15);
  Step a(system_);
  Step b(system_);
  auto za = start_;
  auto zb = start_;
  Compensated<Matrix<double, 8, 8>> m{Matrix<double, 8, 8>::Identity(),
                                      Matrix<double, 8, 8>::Zero()};
  const auto go_on = [](long, const Step&, const auto&) { return true; };
  const FlowReport ra = flow(a, plan, za);
  const FlowReport rb = tangent_flow(b, plan, zb, m, go_on);
  EXPECT_EQ(za.value, zb.value);
  EXPECT_EQ(ra.evaluations, rb.evaluations);
  EXPECT_EQ(ra.steps, rb.steps);
}

// dz(2)/dz(0) = dz(2)/dz(1) dz(1)/dz(0).
TEST_F(FlowTest, TangentsCompose) {
  using M = Matrix<double, 8, 8>;
  const auto go_on = [](long, const Step&, const auto&) { return true; };
  const auto run = [&](State<double, 4>& z, double from, double duration, long steps) {
    Step step(system_);
    Compensated<M> m{M::Identity(), M::Zero()};
    EXPECT_TRUE(
        tangent_flow(step, StepPlan::equal(from, duration, steps), z, m, go_on).completed());
    return m.value;
  };
  auto whole_z = start_;
  auto half_z = start_;
  const M whole = run(whole_z, 0, 2, 20);
  const M first = run(half_z, 0, 1, 10);
  const M second = run(half_z, 1, 1, 10);
  EXPECT_LE(test::relative_distance(M(second * first), whole), 1000 * kEps);
}

}  // namespace
}  // namespace carnot::flow_test
