#include "carnot/flow/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/step/gauss.h"
#include "testing/runs.h"

namespace carnot::trajectory_test {
namespace {

using System = VelocityConstraints<scenes::VehicleCosine>;
using Step = Gauss<System, 3>;
constexpr double kEps = std::numeric_limits<double>::epsilon();

class TrajectoryTest : public ::testing::Test {
 protected:
  const System system_{test::uneven<scenes::VehicleCosine>()};
  const State<double, 4> start_ = test::vehicle_start(system_);

  // The recorded run; the final state in z.
  Trajectory record(const StepPlan& plan, long samples, State<double, 4>& z) const {
    Step step(system_);
    Recorder<Step> recorder(plan, samples, step, z);
    const FlowReport report = flow(step, plan, z, [&](long i, const Step& done, const auto& node) {
      recorder(i, done, node, 0);
      return true;
    });
    EXPECT_TRUE(report.completed());
    return recorder.take();
  }

  // z(t), to round-off.
  [[nodiscard]] Vector<double, 8> exact(double start_time, double t) const {
    Gauss<System, 8> step(system_);
    auto z = start_;
    if (t != start_time) {
      const StepPlan plan = StepPlan::equal(start_time, t - start_time, 100);
      EXPECT_TRUE(flow(step, plan, z).completed());
    }
    return z.value;
  }
};

TEST_F(TrajectoryTest, SamplesAreEquidistantWithBothEnds) {
  for (const long samples : {0L, 1L, 2L, 5L, 21L, 22L, 201L}) {
    for (const double duration : {2.0, -2.0}) {
      const StepPlan plan = StepPlan::of_length(1, duration, duration / 20);
      auto z = start_;
      const Trajectory out = record(plan, samples, z);
      ASSERT_EQ(out.t.size(), static_cast<std::size_t>(samples)) << duration;
      EXPECT_EQ(out.q.size(), out.t.size());
      EXPECT_EQ(out.p.size(), out.t.size());
      EXPECT_EQ(out.lambda.size(), out.t.size());
      EXPECT_EQ(out.hamiltonian.size(), out.t.size());
      if (samples < 2) continue;
      EXPECT_EQ(out.t.front(), plan.start);
      EXPECT_EQ(out.t.back(), plan.end);
      for (int i = 0; i < 4; ++i) {
        EXPECT_EQ(out.q.front()[static_cast<std::size_t>(i)], start_.value[i]);
        EXPECT_EQ(out.q.back()[static_cast<std::size_t>(i)], z.value[i]);
        EXPECT_EQ(out.p.back()[static_cast<std::size_t>(i)], z.value[4 + i]);
      }
      for (std::size_t i = 0; i + 1 < out.t.size(); ++i) {
        const double gap = duration / static_cast<double>(samples - 1);
        EXPECT_NEAR(out.t[i + 1] - out.t[i], gap, 8 * kEps);
      }
    }
  }
}

TEST_F(TrajectoryTest, RecordingDoesNotTouchTheRun) {
  const StepPlan plan = StepPlan::of_length(0, 2, 0.13);
  auto recorded = start_;
  record(plan, 77, recorded);
  auto plain = start_;
  Step step(system_);
  ASSERT_TRUE(flow(step, plan, plain).completed());
  EXPECT_EQ(recorded.value, plain.value);
  EXPECT_EQ(recorded.compensation, plain.compensation);
}

// Samples between nodes are as good as the nodes: the errors are of the method's own size, and
// fall with its order.
TEST_F(TrajectoryTest, SamplesBetweenNodesHaveTheOrderOfTheMethod) {
  double last_error = 0;
  for (const double h : {0.2, 0.1}) {
    auto z = start_;
    const Trajectory out = record(StepPlan::of_length(0, 2, h), 38, z);
    double error = 0;
    for (std::size_t i = 0; i < out.t.size(); ++i) {
      const Vector<double, 8> reference = exact(0, out.t[i]);
      for (int c = 0; c < 4; ++c) {
        const auto k = static_cast<std::size_t>(c);
        error = std::max(error, std::abs(out.q[i][k] - reference[c]));
        error = std::max(error, std::abs(out.p[i][k] - reference[4 + c]));
      }
    }
    const double at_end = (z.value - exact(0, 2)).cwiseAbs().maxCoeff();
    EXPECT_LE(error, 10 * at_end);
    if (last_error > 0) {
      EXPECT_GT(last_error / error, 30);  // 2^6 for order 6
    }
    last_error = error;
  }
}

TEST_F(TrajectoryTest, BackwardsToo) {
  const StepPlan plan = StepPlan::of_length(1, -2, -0.05);
  auto z = start_;
  const Trajectory out = record(plan, 38, z);
  ASSERT_EQ(out.t.size(), 38U);
  constexpr double kMethodError = 1e-8;  // order 6 at h = 0.05
  for (std::size_t i = 0; i < out.t.size(); ++i) {
    const Vector<double, 8> reference = exact(1, out.t[i]);
    for (int c = 0; c < 4; ++c) {
      EXPECT_NEAR(out.q[i][static_cast<std::size_t>(c)], reference[c], kMethodError);
    }
  }
}

TEST_F(TrajectoryTest, RowsAreConsistent) {
  auto z = start_;
  const Trajectory out = record(StepPlan::of_length(0, 2, 0.1), 33, z);
  for (std::size_t i = 0; i < out.t.size(); ++i) {
    const Vector<double, 4> q = vector_at<4>(out.q[i].data());
    const Vector<double, 4> p = vector_at<4>(out.p[i].data());
    const Vector<double, 2> lambda = vector_at<2>(out.lambda[i].data());
    Vector<double, 2> y;
    Rate<double, 4> rate;
    ASSERT_EQ(system_.rate(0.0, q, p, y, rate), RateStatus::kOk);
    // The same formula compiled twice may be contracted differently.
    EXPECT_NEAR(out.hamiltonian[i], system_.hamiltonian(0.0, q, p, y), 16 * kEps);
    const Vector<double, 4> back = system_.momentum(q, rate.q_dot, lambda);
    EXPECT_LE((back - p).cwiseAbs().maxCoeff(), 64 * kEps);
  }
}

}  // namespace
}  // namespace carnot::trajectory_test
