#include "verify/method_audit.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace carnot::apps {
namespace {

constexpr long kGeometrySteps = 20;
// About 50 eps, for 20 steps: measured 1e-16. What breaks a law does so by 1e-12 and more.
constexpr double kRoundOff = 1e-14;
// Of constraints with entries up to 10 and |q'| up to 10; measured 1e-15.
constexpr double kConstraintRoundOff = 1e-13;

Verdict against(bool declared, bool kept) {
  if (kept) return declared ? Verdict::kHolds : Verdict::kFails;
  return declared ? Verdict::kFails : Verdict::kBreaks;
}

// Within 6 % below and 13 % above the order: where the leading term has a small coefficient, as in
// DOP853, the next one adds to the slope. A little further out the leading term does not rule yet;
// a lost order takes 1 from the slope.
Verdict judge_order(const OrderLaw& law, int order) {
  constexpr double kBelow = 0.06;
  constexpr double kAbove = 0.13;
  constexpr double kLost = 0.75;
  if (!resolved(law, order)) return Verdict::kOpen;
  const double excess = law.fit.slope - order;
  if (-kBelow * order <= excess && excess <= kAbove * order) return Verdict::kHolds;
  return std::abs(excess) < kLost ? Verdict::kOpen : Verdict::kFails;
}

// `telling`: whether a method that does not declare the law is known to break it here.
Verdict judge_defect(double defect, bool declared, bool telling) {
  if (std::isnan(defect)) return Verdict::kFails;
  const bool kept = defect <= kRoundOff;
  if (kept && !declared && !telling) return Verdict::kOpen;
  return against(declared, kept);
}

Verdict judge_reversal(const ReversalLaw& law, bool declared, bool telling) {
  const double mirrored = std::isnan(law.mirrored) ? law.adjoint : law.mirrored;
  const bool worse = declared == (mirrored > law.adjoint);
  return judge_defect(worse ? mirrored : law.adjoint, declared, telling);
}

bool energy_is_kept(const EnergyLaw& law) {
  constexpr double kLargestGrowth = 1.5;        // of the largest error after the first tenth
  constexpr double kLargestCorrelation = 0.05;  // of a periodic error, over at least 10 periods
  constexpr double kLargestDrift = 0.1;         // over the run, relative to the largest error
  if (law.largest <= 10 * law.round_off) return true;  // there is nothing else to see
  if (!(law.growth <= kLargestGrowth)) return false;
  // NaN where H depends on time: the growth alone tells.
  return !(std::abs(law.correlation) > kLargestCorrelation) &&
         !(std::abs(law.drift) > kLargestDrift);
}

Verdict judge_energy(const EnergyLaw& law, const Method& method) {
  if (!law.report.completed()) return against(method.symplectic, false);
  const bool kept = energy_is_kept(law);
  if (kept && !method.symplectic) return Verdict::kOpen;  // its drift is slower than it shows
  return against(method.symplectic, kept);
}

Verdict judge_constraints(const MethodAudit& audit, const Dynamics& dynamics) {
  if (dynamics.multipliers == 0 && dynamics.holonomic == 0) return Verdict::kNotAsked;
  const bool at_middles = !(audit.midpoint_constraint > kConstraintRoundOff);  // or not measured
  return against(true,
                 audit.energy.constraint_error <= kConstraintRoundOff &&
                     audit.energy.holonomic_error <= kConstraintRoundOff && at_middles);
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string_view describe(Verdict verdict) {
  switch (verdict) {
    case Verdict::kHolds:
      return "holds";
    case Verdict::kBreaks:
      return "breaks";
    case Verdict::kFails:
      return "fails";
    case Verdict::kOpen:
      return "open";
    case Verdict::kNotAsked:
      return "not asked";
  }
  return "";
}

bool resolved(const OrderLaw& law, int order) {
  constexpr int kFewestPoints = 3;
  constexpr int kHighestOrder = 12;  // beyond, the leading term rules below round-off only
  constexpr double kLeastCorrelation = 0.99;
  constexpr double kLargestUncertainty = 0.03;  // standard error of the slope over the order
  return order <= kHighestOrder && law.fit.points >= kFewestPoints &&
         law.fit.correlation > kLeastCorrelation &&
         law.fit.standard_error <= kLargestUncertainty * order;
}

bool MethodAudit::as_declared() const {
  const auto verdicts = {
      order_verdict, symplecticity_verdict, reversal_verdict, energy_verdict, constraint_verdict};
  return std::find(verdicts.begin(), verdicts.end(), Verdict::kFails) == verdicts.end();
}

std::string MethodAudit::remark() const {
  const std::vector<std::pair<const char*, Verdict>> laws{{"order", order_verdict},
                                                          {"symplecticity", symplecticity_verdict},
                                                          {"reversal", reversal_verdict},
                                                          {"energy", energy_verdict},
                                                          {"constraints", constraint_verdict}};
  const auto named = [&](Verdict verdict) {
    std::vector<std::string> names;
    for (const auto& [name, of_law] : laws) {
      if (of_law == verdict) names.emplace_back(name);
    }
    return joined(names);
  };
  const std::string failed = named(Verdict::kFails);
  if (!failed.empty()) return "FAILS: " + failed;
  const std::string broken = named(Verdict::kBreaks);
  std::string text = broken.empty() ? "holds" : "breaks " + broken + ", as it must";
  const std::string open = named(Verdict::kOpen);
  if (!open.empty()) text += "; " + open + " open";
  return text;
}

MethodAudit audit_step(const AuditSubject& subject,
                       const Method& method,
                       const ReferenceRun& reference) {
  const Dynamics dynamics = subject.dynamics(method.name);
  MethodAudit audit;
  audit.scene = subject.entry->info.name;
  audit.method = method;
  audit.order = measure_order(dynamics, reference);
  audit.symplecticity =
      measure_symplecticity(dynamics, subject.start, subject.step, kGeometrySteps);
  audit.reversal = measure_reversal(dynamics, subject.start, subject.step, kGeometrySteps);
  audit.order_verdict = judge_order(audit.order, method.order);
  audit.symplecticity_verdict =
      judge_defect(audit.symplecticity, method.symplectic, subject.telling);
  audit.reversal_verdict = judge_reversal(audit.reversal, method.symmetric, subject.telling);
  audit.energy_verdict = audit.constraint_verdict = Verdict::kNotAsked;
  return audit;
}

MethodAudit audit_method(const AuditSubject& subject,
                         const Method& method,
                         const ReferenceRun& reference,
                         const Progress& progress) {
  MethodAudit audit = audit_step(subject, method, reference);
  const Dynamics dynamics = subject.dynamics(method.name);
  const bool bounded = subject.energy_step > 0;
  const double step = bounded ? subject.energy_step : subject.step;
  const long steps = bounded ? subject.energy_steps : kGeometrySteps;
  audit.energy = measure_energy(dynamics, subject.start, step, steps, progress);
  if (bounded) audit.energy_verdict = judge_energy(audit.energy, method);
  const bool midpoint_rule = method.family == kGaussFamily && method.stages == 1;
  if (midpoint_rule) {
    audit.midpoint_constraint =
        measure_midpoint_constraint(dynamics, subject.start, subject.step, kGeometrySteps);
  }
  audit.constraint_verdict = judge_constraints(audit, dynamics);
  return audit;
}

}  // namespace carnot::apps
