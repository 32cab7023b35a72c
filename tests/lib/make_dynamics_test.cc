// The calls of a Dynamics against the templates behind them.
#include "carnot/make_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/flow/tangent_flow.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"
#include "carnot/step/gauss.h"
#include "carnot/system/erased_system.h"
#include "testing/runs.h"

namespace carnot::make_dynamics_test {
namespace {

using System = VelocityConstraints<scenes::VehicleCosine>;
constexpr int n = 4;
// The system as the compiled kernels see it.
using Step = Gauss<ErasedSystem<n>, 1>;
constexpr int k = 2;
constexpr double kEps = std::numeric_limits<double>::epsilon();

class MakeDynamics : public ::testing::Test {
 protected:
  const scenes::VehicleCosine scene_ = test::uneven<scenes::VehicleCosine>();
  const System system_{scene_};
  const SystemOnBranch<System> on_branch_{system_};
  const ErasedSystem<n> erased_{&on_branch_, functions_of<System>()};
  const Dynamics dynamics_ = make_dynamics(scene_, "midpoint");
  const State<double, n> start_ = test::vehicle_start(system_);
  const StepPlan plan_ = StepPlan::of_length(0, 1, 0.15);
};

TEST_F(MakeDynamics, KnowsItsSizes) {
  EXPECT_EQ(dynamics_.dof, n);
  EXPECT_EQ(dynamics_.multipliers, k);
  EXPECT_EQ(dynamics_.order, 2);
  EXPECT_EQ(dynamics_.info.name, "vehicle-cosine");
}

TEST_F(MakeDynamics, FlowIsTheFlow) {
  Step step(erased_);
  auto expected = start_;
  const FlowReport by_template = flow(step, plan_, expected);
  Vector<double, 2 * n> z = start_.value;
  const FlowReport report = dynamics_.flow(plan_, span_of(z));
  EXPECT_TRUE(report.completed());
  EXPECT_EQ(report.evaluations, by_template.evaluations);
  EXPECT_EQ(report.time_reached, 1);
  EXPECT_EQ(z, expected.value);
}

TEST_F(MakeDynamics, TangentIsRowMajor) {
  using Square = Matrix<double, 2 * n, 2 * n>;
  Step step(erased_);
  auto expected = start_;
  Compensated<Square> m{Square::Identity(), Square::Zero()};
  const auto go_on = [](long, const Step&, const auto&) { return true; };
  ASSERT_TRUE(tangent_flow(step, plan_, expected, m, go_on).completed());
  Vector<double, 2 * n> z = start_.value;
  std::vector<double> rows(4 * n * n);
  ASSERT_TRUE(dynamics_.tangent_flow(plan_, span_of(z), rows).completed());
  EXPECT_EQ(z, expected.value);
  // The compiled kernel fuses products and sums, which this file, with less optimisation, does not.
  const double round_off = 64 * kEps * largest_entry(m.value);
  ASSERT_GT(largest_entry(Square(m.value - m.value.transpose())), 0.1) << "rows are no columns";
  for (int i = 0; i < 2 * n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      EXPECT_NEAR(rows[static_cast<std::size_t>(2 * n * i + j)], m.value(i, j), round_off);
    }
  }
}

TEST_F(MakeDynamics, AuditedFlowMeasuresTheSameRun) {
  Vector<double, 2 * n> plain = start_.value;
  Vector<double, 2 * n> audited = start_.value;
  ASSERT_TRUE(dynamics_.flow(plan_, span_of(plain)).completed());
  MonitorOptions options;
  options.samples = 11;
  const FlowSummary summary = dynamics_.monitored_flow(plan_, span_of(audited), options);
  ASSERT_TRUE(summary.completed());
  EXPECT_EQ(audited, plain);
  EXPECT_EQ(summary.trajectory.t.size(), 11U);
  EXPECT_GT(summary.length, 0);
  EXPECT_GT(summary.energy_drift, 0);
  EXPECT_LE(summary.constraint_error, 16 * kEps);
}

TEST_F(MakeDynamics, ProgressMayStop) {
  Vector<double, 2 * n> z = start_.value;
  MonitorOptions options;
  std::vector<double> fractions;
  options.progress = [&](double fraction) {
    fractions.push_back(fraction);
    return fractions.size() < 3;
  };
  const FlowSummary summary =
      dynamics_.monitored_flow(StepPlan::equal(0, 10, 10000), span_of(z), options);
  EXPECT_EQ(summary.report.status, FlowStatus::kStopped);
  EXPECT_LT(summary.report.time_reached, 10);
  ASSERT_EQ(fractions.size(), 3U);
  EXPECT_LT(fractions[0], fractions[1]);
  EXPECT_LT(fractions[1], fractions[2]);
  EXPECT_NEAR(summary.report.time_reached, 10 * fractions[2], 0.01);
}

// evaluate() and momentum() are inverse to each other.
TEST_F(MakeDynamics, EvaluateAndMomentumAgree) {
  test::Generator generator(1);
  for (int sample = 0; sample < 50; ++sample) {
    const auto q = test::random_vector<n>(generator, 2);
    const auto p = test::random_vector<n>(generator, 2);
    Vector<double, n> v;
    Vector<double, k> lambda;
    const PointValues values =
        dynamics_.evaluate(0, span_of(q), span_of(p), span_of(v), span_of(lambda));
    ASSERT_EQ(values.status, RateStatus::kOk);
    EXPECT_NEAR(values.hamiltonian, p.dot(v) - system_.lagrangian(q, v), 64 * kEps);
    Vector<double, n> back;
    Vector<double, n> projected = v;
    const double violated =
        dynamics_.momentum(0, span_of(q), span_of(projected), span_of(lambda), span_of(back));
    EXPECT_LE(violated, 64 * kEps);
    EXPECT_LE((projected - v).cwiseAbs().maxCoeff(), 64 * kEps);
    EXPECT_LE((back - p).cwiseAbs().maxCoeff(), 256 * kEps);
  }
}

TEST_F(MakeDynamics, MomentumProjectsTheVelocityAndSaysHowFar) {
  const Vector<double, n> q(0, 0, 0, 0);
  Vector<double, n> v(3, 4, 0, 0);  // 4 sideways out of 5
  const Vector<double, k> lambda(0, 0);
  Vector<double, n> p;
  EXPECT_DOUBLE_EQ(dynamics_.momentum(0, span_of(q), span_of(v), span_of(lambda), span_of(p)), 0.8);
  EXPECT_LE(system_.constraint(q, v).norm(), 8 * kEps);
  EXPECT_NEAR(v[0], 3, 8 * kEps);
  Vector<double, n> rest(0, 0, 0, 0);
  EXPECT_EQ(dynamics_.momentum(0, span_of(q), span_of(rest), span_of(lambda), span_of(p)), 0);
}

// A message of validate() names the parameter.
template <class Scene>
std::string complaint(const Scene& scene) {
  try {
    validate(scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ValidateTest, NamesTheParameter) {
  const double nan = std::nan("");
  const double inf = std::numeric_limits<double>::infinity();
  using scenes::Unicycle;
  using scenes::Vehicle;
  EXPECT_EQ(complaint(Vehicle{}), "");
  EXPECT_EQ(complaint(Vehicle{0, 1, 1}), "");  // a body without inertia is fine
  for (const double bad : {-1.0, nan, inf, -inf}) {
    EXPECT_NE(complaint(Vehicle{bad, 1, 1}).find("alpha"), std::string::npos);
  }
  for (const double bad : {0.0, -1.0, nan, inf}) {
    EXPECT_NE(complaint(Vehicle{1, bad, 1}).find("beta"), std::string::npos);
    EXPECT_NE(complaint(Vehicle{1, 1, bad}).find("length"), std::string::npos);
    EXPECT_NE(complaint(Unicycle{bad}).find("beta"), std::string::npos);
    EXPECT_NE(complaint(scenes::VehicleCosine{{1, 1, bad}}).find("length"), std::string::npos);
  }
  EXPECT_EQ(complaint(scenes::Heisenberg{}), "");  // no parameters
}

TEST(ValidateTest, ASegmentOfABadSceneIsRefused) {
  const scenes::VehicleCosine bad{{1, -2.5, 1}};
  try {
    (void)make_dynamics(bad, "midpoint");
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("-2.5"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace carnot::make_dynamics_test
