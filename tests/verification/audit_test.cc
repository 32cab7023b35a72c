// Every method on a scene of every kind: what `carnot verify` prints, as assertions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "carnot/laws/laws.h"
#include "carnot/tableau/methods.h"
#include "catalogue/scene_choice.h"
#include "verify/method_audit.h"

namespace carnot::apps::audit_test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();
constexpr long kSteps = 20;

AuditSubject subject_of(const std::string& scene) { return *audit_subject(find_scene(scene)); }

// All that suit; RATTLE where there are holonomic constraints only.
std::vector<Method> methods_of(const AuditSubject& subject) {
  std::vector<Method> chosen;
  for (const Method& method : methods()) {
    const bool needless = method.family == kRattleFamily && subject.entry->holonomic == 0;
    if (subject.entry->suits(method) && !needless) chosen.push_back(method);
  }
  return chosen;
}

class AuditTest : public ::testing::TestWithParam<std::string> {
 protected:
  const AuditSubject subject_ = subject_of(GetParam());
};

// Slopes over four or five decades. Where the leading term does not rule above round-off the
// measurement is open; that happens to orders above 8 alone. DOP853 has a small leading term.
TEST_P(AuditTest, OrderIsTheSlope) {
  constexpr int kAlwaysResolved = 8;
  constexpr int kHighestOrder = 12;
  const ReferenceRun reference = audit_reference(subject_);
  ASSERT_LE(reference.error, 100 * kEps);
  for (const Method& method : methods_of(subject_)) {
    SCOPED_TRACE(method.name);
    const OrderLaw law = measure_order(subject_.dynamics(method.name), reference);
    if (method.order > kHighestOrder) {
      EXPECT_FALSE(resolved(law, method.order));
      continue;
    }
    EXPECT_GE(law.fit.points, 3);
    EXPECT_GT(law.fit.slope, 0.75 * method.order);
    if (!resolved(law, method.order)) {
      EXPECT_GT(method.order, kAlwaysResolved);
      continue;
    }
    EXPECT_GT(law.fit.correlation, 0.99);
    EXPECT_GT(law.fit.slope, 0.94 * method.order);
    EXPECT_LT(law.fit.slope, (method.family == kDop853Family ? 1.13 : 1.06) * method.order);
  }
}

// 20 steps: round-off of their products, 50 eps, relative to |M|^2.
TEST_P(AuditTest, SymplecticMethodsAloneKeepTheForm) {
  constexpr double kRoundOff = 50 * kEps;
  for (const Method& method : methods_of(subject_)) {
    SCOPED_TRACE(method.name);
    const double defect = measure_symplecticity(
        subject_.dynamics(method.name), subject_.start, subject_.step, kSteps);
    if (method.symplectic) {
      EXPECT_LE(defect, kRoundOff);
    } else {
      EXPECT_GT(defect, 10 * kRoundOff);
    }
  }
}

TEST_P(AuditTest, SymmetricMethodsAloneRunBackwards) {
  constexpr double kRoundOff = 50 * kEps;
  for (const Method& method : methods_of(subject_)) {
    SCOPED_TRACE(method.name);
    const ReversalLaw law =
        measure_reversal(subject_.dynamics(method.name), subject_.start, subject_.step, kSteps);
    if (method.symmetric) {
      EXPECT_LE(law.adjoint, kRoundOff);
      EXPECT_FALSE(law.mirrored > kRoundOff);  // NaN where flipping p is no reversal
    } else {
      EXPECT_GT(law.adjoint, 10 * kRoundOff);
      EXPECT_FALSE(law.mirrored <= 10 * kRoundOff);
    }
  }
}

// Entries of the constraints and velocities of order one; whatever the step.
TEST_P(AuditTest, ConstraintsHoldToRoundOff) {
  constexpr double kRoundOff = 100 * kEps;
  for (const Method& method : methods_of(subject_)) {
    SCOPED_TRACE(method.name);
    const EnergyLaw law = measure_energy(
        subject_.dynamics(method.name), subject_.start, subject_.step, 2 * kSteps, Progress());
    EXPECT_LE(law.constraint_error, kRoundOff);
    EXPECT_LE(law.holonomic_error, kRoundOff);
  }
}

std::string plain_name(const ::testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         AuditTest,
                         ::testing::ValuesIn(default_audit_scenes()),
                         plain_name);

// Scenes whose holonomic constraint is kept by every method that keeps quadratic invariants.
TEST(ProductScenes, KeepTheLawsOfEveryMethodThatSuits) {
  constexpr double kRoundOff = 100 * kEps;
  constexpr int kResolved = 6;  // orders: their motion is smooth
  for (const char* scene : {"satellite-quaternion", "plate-ball-quaternion"}) {
    const AuditSubject subject = subject_of(scene);
    const ReferenceRun reference = audit_reference(subject);
    EXPECT_FALSE(subject.entry->suits(*find_method("radau5")));
    for (const Method& method : methods_of(subject)) {
      SCOPED_TRACE(method.name);
      const Dynamics dynamics = subject.dynamics(method.name);
      EXPECT_LE(measure_symplecticity(dynamics, subject.start, subject.step, kSteps), kRoundOff);
      const EnergyLaw law =
          measure_energy(dynamics, subject.start, subject.step, 2 * kSteps, Progress());
      EXPECT_LE(law.constraint_error, kRoundOff);
      EXPECT_LE(law.holonomic_error, kRoundOff);
      if (method.order > kResolved) continue;
      EXPECT_TRUE(resolved(measure_order(dynamics, reference), method.order));
    }
  }
}

TEST(AuditOrder, IsResolvedUpToTwelve) {
  const AuditSubject subject = subject_of("heisenberg");
  const ReferenceRun reference = audit_reference(subject);
  for (const char* name : {"gauss10", "gauss12"}) {
    const Method& method = *find_method(name);
    EXPECT_TRUE(resolved(measure_order(subject.dynamics(name), reference), method.order)) << name;
  }
}

// Over 1e5 steps, with one method of each family on a scene of each kind.
struct LongRun {
  const char* scene;
  const char* method;
};

class LongRunTest : public ::testing::TestWithParam<LongRun> {};

TEST_P(LongRunTest, EnergyErrorForgetsTheTime) {
  constexpr long kManySteps = 100000;
  const AuditSubject subject = subject_of(GetParam().scene);
  const EnergyLaw law = measure_energy(subject.dynamics(GetParam().method),
                                       subject.start,
                                       subject.energy_step,
                                       kManySteps,
                                       Progress());
  ASSERT_TRUE(law.report.completed()) << law.report.reason();
  EXPECT_EQ(law.report.steps, kManySteps);
  EXPECT_GT(law.largest, 1e4 * kEps) << "the step is too small to show anything";
  EXPECT_LE(law.growth, 1.25);  // after the first tenth
  const bool autonomous = subject.dynamics(GetParam().method).autonomous;
  EXPECT_EQ(std::isnan(law.correlation), !autonomous);
  if (!autonomous) return;  // the growth of H - H0 - integral of H_t tells
  EXPECT_LT(std::abs(law.correlation), 0.02);
  EXPECT_LT(std::abs(law.drift), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Runs,
                         LongRunTest,
                         ::testing::Values(LongRun{"heisenberg", "gauss8"},
                                           LongRun{"vehicle", "midpoint4"},
                                           LongRun{"bicycle", "lobatto4"},
                                           LongRun{"appell", "midpoint"},
                                           LongRun{"kapitza-pendulum", "gauss4"},
                                           LongRun{"magnetic-particle", "lobatto2"},
                                           LongRun{"spherical-pendulum", "rattle"}),
                         [](const auto& run) {
                           return plain_name({std::string(run.param.scene), run.index});
                         });

TEST(LongRun, EnergyDriftsWithoutSymplecticity) {
  const AuditSubject subject = subject_of("heisenberg");
  for (const char* name : {"radau5", "radau9", "dop853"}) {
    const EnergyLaw law = measure_energy(
        subject.dynamics(name), subject.start, subject.energy_step, 10000, Progress());
    EXPECT_GT(law.growth, 5) << name;
    EXPECT_LT(law.correlation, -0.9) << name;
  }
}

// What does not hold by construction: g at the middle of two nodes, on their difference quotient.
TEST(MidpointConstraint, HoldsForTheMidpointRuleAlone) {
  const AuditSubject subject = subject_of("vehicle");
  const auto measured = [&](const char* method) {
    return measure_midpoint_constraint(
        subject.dynamics(method), subject.start, subject.step, kSteps);
  };
  EXPECT_LE(measured("midpoint"), 100 * kEps);
  EXPECT_GT(measured("gauss4"), 1e-6);
  const AuditSubject drift = subject_of("pendulum");  // no transcription
  EXPECT_TRUE(std::isnan(
      measure_midpoint_constraint(drift.dynamics("midpoint"), drift.start, drift.step, kSteps)));
}

// A method that claims too much, or too little, is found out.
TEST(MethodAudit, SeesThroughFalseClaims) {
  const AuditSubject subject = subject_of("heisenberg");
  const ReferenceRun reference = audit_reference(subject);
  const auto audited = [&](Method method) { return audit_step(subject, method, reference); };
  Method gauss4 = *find_method("gauss4");
  Method radau5 = *find_method("radau5");
  EXPECT_TRUE(audited(gauss4).as_declared());
  EXPECT_TRUE(audited(radau5).as_declared());
  EXPECT_EQ(audited(radau5).remark(), "breaks symplecticity, reversal, as it must");

  gauss4.order = 5;
  EXPECT_EQ(audited(gauss4).order_verdict, Verdict::kFails);
  EXPECT_EQ(audited(gauss4).remark(), "FAILS: order");
  gauss4.order = 4;
  gauss4.symplectic = gauss4.symmetric = false;
  EXPECT_EQ(audited(gauss4).symplecticity_verdict, Verdict::kFails);
  EXPECT_EQ(audited(gauss4).reversal_verdict, Verdict::kFails);
  radau5.symplectic = radau5.symmetric = true;
  EXPECT_EQ(audited(radau5).symplecticity_verdict, Verdict::kFails);
  EXPECT_EQ(audited(radau5).reversal_verdict, Verdict::kFails);
  EXPECT_FALSE(audited(radau5).as_declared());
}

TEST(MethodAudit, SaysWhatWasNotMeasured) {
  AuditSubject subject = subject_of("heisenberg");
  subject.step = 1e3;  // no stage equations converge
  const ReferenceRun reference = audit_reference(subject);
  const MethodAudit audit = audit_step(subject, *find_method("gauss4"), reference);
  EXPECT_TRUE(std::isnan(audit.symplecticity));
  EXPECT_TRUE(std::isnan(audit.reversal.adjoint));
  EXPECT_EQ(audit.symplecticity_verdict, Verdict::kFails);
  EXPECT_FALSE(audit.as_declared());
  EXPECT_TRUE(measure_order(subject.dynamics("gauss4"), ReferenceRun()).errors.empty());
}

}  // namespace
}  // namespace carnot::apps::audit_test
