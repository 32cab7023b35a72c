// Steps chosen by a trial: the error is about what was asked for.
#include "carnot/flow/automatic_flow.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/step/gauss.h"
#include "testing/program_scenes.h"
#include "testing/runs.h"

namespace carnot::automatic_flow_test {
namespace {

using test::Generator;

template <class Scene>
class AutomaticFlowTest : public ::testing::Test {
 protected:
  using Point = Vector<double, 2 * Scene::kDof>;

  const Dynamics dynamics_ = test::program_dynamics(test::uneven<Scene>(), "gauss16");

  // By 40 steps of order 16 a unit of time.
  Point exact(const Point& start, double duration) const {
    Point z = start;
    const auto plan = StepPlan::equal(0, duration, std::lround(40 * std::abs(duration)) + 1);
    EXPECT_TRUE(dynamics_.flow(plan, span_of(z)).completed());
    return z;
  }
};

TYPED_TEST_SUITE(AutomaticFlowTest, test::Scenes, test::SceneNames);

// The trial tells the error to about a digit.
TYPED_TEST(AutomaticFlowTest, ReachesTheTolerance) {
  constexpr double kBeyond = 50;
  Generator generator(5);
  for (int sample = 0; sample < 5; ++sample) {
    const auto start = test::random_state<TypeParam::kDof>(generator).value;
    for (const double duration : {0.5, 6.0, -4.0}) {
      const auto expected = this->exact(start, duration);
      for (const double tolerance : {1e-5, 1e-7, 1e-10}) {
        auto z = start;
        const AutomaticFlow run =
            this->dynamics_.automatic_flow(0, duration, tolerance, span_of(z));
        ASSERT_TRUE(run.reached) << duration << " " << tolerance;
        EXPECT_LE((z - expected).cwiseAbs().maxCoeff(), kBeyond * tolerance) << duration;
        EXPECT_LE(run.error, tolerance);
        EXPECT_GE(run.evaluations, run.report.evaluations);
        EXPECT_EQ(run.plan.end, duration);
      }
    }
  }
}

// The plan that it reports, run again, gives the same bits.
TYPED_TEST(AutomaticFlowTest, ReportsTheRunThatItMade) {
  using System = VelocityConstraints<TypeParam>;
  Generator generator(6);
  const System system(test::uneven<TypeParam>());
  const Gauss<System, 8> fresh(system);
  const auto start = test::random_state<TypeParam::kDof>(generator);
  auto z = start;
  const AutomaticFlow run = automatic_flow(fresh, 0, 5, 1e-9, z);
  ASSERT_TRUE(run.reached);
  auto again = start;
  Gauss<System, 8> step(system);
  EXPECT_EQ(flow(step, run.plan, again).evaluations, run.report.evaluations);
  EXPECT_EQ(again.value, z.value);
}

// Angles are kept small as in flow(), so that the plan gives the same bits after many turns, too.
TEST(AutomaticFlow, TakesWholeTurnsOff) {
  const Dynamics dynamics = test::program_dynamics(scenes::Unicycle{}, "gauss16");
  std::vector<double> z{0, 0, 0, 0.3, 0.2, 20};
  std::vector<double> again = z;
  const AutomaticFlow run = dynamics.automatic_flow(0, 50, 1e-8, z);
  ASSERT_TRUE(run.reached);
  EXPECT_GT(std::abs(z[2]), 100);
  ASSERT_TRUE(dynamics.flow(run.plan, again).completed());
  EXPECT_EQ(again, z);
}

// Every Gauss method whose polynomial has enough coefficients to see them fall, and no other.
TEST(AutomaticFlow, ServesGaussMethodsOfOrderEightAndMore) {
  constexpr double kBeyond = 50;
  const std::array<double, 8> start = {1, 0.5, 0.3, 0.8, 0.7, 0.7, 0.5, 0.2};
  auto expected = start;
  const Dynamics exact = test::program_dynamics(scenes::VehicleCosine{}, "gauss16");
  ASSERT_TRUE(exact.flow(StepPlan::equal(0, 5, 200), expected).completed());
  for (const char* method : {"gauss8", "gauss10", "gauss12", "gauss14", "gauss20", "gauss24"}) {
    const Dynamics dynamics = test::program_dynamics(scenes::VehicleCosine{}, method);
    ASSERT_TRUE(dynamics.has_automatic_flow()) << method;
    for (const double tolerance : {1e-5, 1e-9}) {
      auto z = start;
      const AutomaticFlow run = dynamics.automatic_flow(0, 5, tolerance, z);
      EXPECT_TRUE(run.reached) << method;
      EXPECT_LE((vector_at<8>(z.data()) - vector_at<8>(expected.data())).cwiseAbs().maxCoeff(),
                kBeyond * tolerance)
          << method;
    }
  }
  for (const char* method : {"midpoint", "gauss4", "gauss6", "lobatto8", "radau9", "dop853"}) {
    EXPECT_FALSE(test::program_dynamics(scenes::VehicleCosine{}, method).has_automatic_flow())
        << method;
  }
}

// Where errors grow by 500, a second run finds that out.
TEST(AutomaticFlow, SeesErrorsGrow) {
  using System = VelocityConstraints<scenes::VehicleCosine>;
  const System system(scenes::VehicleCosine{});
  const auto start = test::vehicle_start(system);
  Gauss<System, 8, long double> wide(system);
  auto expected = test::cast_state<long double, System::kDof>(start);
  ASSERT_TRUE(flow(wide, StepPlan::equal(0, 20, 1000), expected).completed());
  const Gauss<System, 8> fresh(system);
  for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
    auto z = start;
    ASSERT_TRUE(automatic_flow(fresh, 0, 20, tolerance, z).reached);
    EXPECT_LE((z.value - expected.value.cast<double>()).cwiseAbs().maxCoeff(), 10 * tolerance);
  }
}

TEST(AutomaticFlow, LeavesTheStateWhereItFails) {
  using System = VelocityConstraints<scenes::VehicleCosine>;
  const System system(scenes::VehicleCosine{});
  const auto start = test::vehicle_start(system);
  const Gauss<System, 8> fresh(system);
  auto z = start;
  EXPECT_FALSE(automatic_flow(fresh, 0, 10, 1e-18, z).reached);  // below round-off
  EXPECT_EQ(z.value, start.value);
  z.value[4] = std::nan("");
  EXPECT_FALSE(automatic_flow(fresh, 0, 10, 1e-8, z).reached);
  EXPECT_TRUE(std::isnan(z.value[4]));
}

TEST(AutomaticFlow, OfARestIsARest) {
  const std::array<double, 8> start = {1, 2, 3, 4, 0, 0, 0, 0};
  auto z = start;
  EXPECT_TRUE(
      test::program_dynamics(scenes::Vehicle{}, "gauss16").automatic_flow(0, 10, 1e-10, z).reached);
  EXPECT_EQ(z, start);
}

}  // namespace
}  // namespace carnot::automatic_flow_test
