// Steps of RATTLE that cannot be done: the reason is named and the state is what it was.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "carnot/flow/flow.h"
#include "carnot/scenes/spherical_pendulum.h"
#include "carnot/step/rattle.h"
#include "carnot/system/velocity_constraints.h"
#include "carnot/tableau/composition_tableau.h"
#include "testing/counting_system.h"

namespace carnot::rattle_failure_test {
namespace {

using Pendulum = test::CountingSystem<VelocityConstraints<scenes::SphericalPendulum>>;

// On the plane, h = (|q|^2 - 1)/2 and the velocity constraint q.q' = 0 that h implies.
struct Tautology {
  static constexpr int kDof = 2;
  static constexpr int kMultipliers = 1;
  static constexpr int kHolonomic = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> mass(const Vector<T, 2>& /*q*/) const {
    Matrix<T, 2, 2> m = Matrix<T, 2, 2>::Constant(constant<T>(0));
    m(0, 0) = m(1, 1) = constant<T>(1);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 1, 2> constraints(const Vector<T, 2>& q) const {
    return {q[0], q[1]};
  }
  template <class T>
  [[nodiscard]] Vector<T, 1> holonomic(const Vector<T, 2>& q) const {
    return Vector<T, 1>(constant<T>(0.5) * (dot(q, q) - constant<T>(1)));
  }
};

template <class System>
StepReport failed_step(const System& system, const State<double, System::kDof>& start, double h) {
  const Tableau<double> tableau = composition_tableau<double>(4);
  Rattle<System> method(system, tableau);
  auto z = start;
  z.compensation.setConstant(1e-20);
  const auto before = z;
  const StepReport report = method.step(0, h, z);
  EXPECT_NE(report.status, StepStatus::kOk);
  EXPECT_EQ(method.last_step(), 0);
  // Bit for bit, not-a-numbers included.
  for (int i = 0; i < 2 * System::kDof; ++i) {
    EXPECT_TRUE(z.value[i] == before.value[i] || std::isnan(before.value[i]));
    EXPECT_EQ(z.compensation[i], before.compensation[i]);
  }
  return report;
}

const Pendulum kPendulum{scenes::SphericalPendulum{}};
const State<double, 3> kStart = make_state<double, 3>({0.6, 0, -0.8}, {0.4, 0.5, 0.3});

// At the centre every direction is as good as any other: Dh = 0.
TEST(RattleFailureTest, SingularHolonomicJacobian) {
  const auto centre = make_state<double, 3>({0, 0, 0}, {1, 0, 0});
  const StepReport report = failed_step(kPendulum, centre, 0.1);
  EXPECT_EQ(report.status, StepStatus::kRateFailed);
  EXPECT_EQ(report.rate, RateStatus::kConstraintRank);
}

// The velocity constraint already holds the motion on h = 0: the impulse is undetermined.
TEST(RattleFailureTest, HolonomicAndVelocityConstraintsDependent) {
  const VelocityConstraints<Tautology> system({});
  const StepReport report =
      failed_step(system, make_state<double, 2>({0.6, 0.8}, {-0.8, 0.6}), 0.1);
  EXPECT_EQ(report.status, StepStatus::kRateFailed);
  EXPECT_EQ(report.rate, RateStatus::kConstraintRank);
}

// Steps of many swings have no solution near by.
TEST(RattleFailureTest, HugeSteps) {
  for (const double h : {10.0, 1e3, -1e6}) {
    EXPECT_EQ(failed_step(kPendulum, kStart, h).status, StepStatus::kStagesDiverged) << h;
  }
}

TEST(RattleFailureTest, NotANumberInAnyComponent) {
  for (int i = 0; i < 6; ++i) {
    auto z = kStart;
    z.value[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(failed_step(kPendulum, z, 0.1).rate, RateStatus::kNotFinite) << "component " << i;
  }
}

// From anywhere a step ends on the manifold, to the rounding of where it began, or it says that it
// does not.
TEST(RattleFailureTest, StartsFarOffTheManifold) {
  const Tableau<double> tableau = composition_tableau<double>(2);
  int refused = 0;
  for (const double size : {1e-9, 1e-3, 0.3, 2.0, 30.0, 1e5, 1e12}) {
    for (const double h : {0.001, 0.1, 1.0}) {
      Rattle<Pendulum> method(kPendulum, tableau);
      auto z = kStart;
      z.value.head<3>() *= size;
      const auto before = z;
      const StepReport report = method.step(0, h, z);
      if (report.status == StepStatus::kOk) {
        const double rounding = 32 * epsilon<double>() * std::max(1.0, size);
        EXPECT_LE(std::abs(z.value.head<3>().norm() - 1), rounding) << size;
        EXPECT_TRUE(z.value.allFinite());
      } else {
        ++refused;
        EXPECT_EQ(z.value, before.value);
      }
    }
  }
  EXPECT_GT(refused, 0);
}

// Any single call of the rate may fail: the state is unchanged, and the stepper serves again as if
// new.
TEST(RattleFailureTest, RateFailsAtAnyCall) {
  const Tableau<double> tableau = composition_tableau<double>(4);
  Pendulum system{scenes::SphericalPendulum{}};
  Rattle<Pendulum> method(system, tableau);
  auto expected = kStart;
  const StepReport whole = method.step(0, 0.1, expected);
  ASSERT_EQ(whole.status, StepStatus::kOk);
  EXPECT_EQ(whole.evaluations, system.calls);
  for (long call = 1; call <= whole.evaluations; ++call) {
    system.calls = 0;
    system.fail_from = system.fail_to = call;
    auto z = kStart;
    const StepReport report = method.step(0, 0.1, z);
    EXPECT_EQ(report.status, StepStatus::kRateFailed) << "call " << call;
    EXPECT_EQ(report.rate, RateStatus::kNotFinite) << "call " << call;
    EXPECT_EQ(z.value, kStart.value);
    system.fail_from = system.fail_to = -1;
    ASSERT_EQ(method.step(0, 0.1, z).status, StepStatus::kOk);
    EXPECT_EQ(z.value, expected.value);
  }
}

// A flow says how far it came.
TEST(RattleFailureTest, FlowReportsTheReason) {
  const Tableau<double> tableau = composition_tableau<double>(2);
  Rattle<Pendulum> method(kPendulum, tableau);
  auto z = kStart;
  const FlowReport report = flow(method, StepPlan::equal(0, 100, 10), z);
  EXPECT_EQ(report.status, FlowStatus::kStepFailed);
  EXPECT_EQ(report.time_reached, 0);
  EXPECT_FALSE(report.reason().empty());
}

}  // namespace
}  // namespace carnot::rattle_failure_test
