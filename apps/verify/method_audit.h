// What a method declares, held against what laws.h measures on a scene.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carnot/tableau/methods.h"
#include "verify/audit_subject.h"

namespace carnot::apps {

enum class Verdict {
  kHolds,     // the law is kept
  kBreaks,    // broken, as a method that does not declare it must
  kFails,     // not as declared
  kOpen,      // measured, but this run in double does not tell
  kNotAsked,  // the law says nothing here
};

// "holds", "breaks", "fails", "open", "not asked".
std::string_view describe(Verdict verdict);

struct MethodAudit {
  std::string scene;
  Method method;
  OrderLaw order;
  double symplecticity = kNotMeasured;
  ReversalLaw reversal;
  EnergyLaw energy;
  double midpoint_constraint = kNotMeasured;  // of the midpoint rule only

  Verdict order_verdict = Verdict::kFails;
  Verdict symplecticity_verdict = Verdict::kFails;
  Verdict reversal_verdict = Verdict::kFails;
  Verdict energy_verdict = Verdict::kFails;
  Verdict constraint_verdict = Verdict::kFails;

  [[nodiscard]] bool as_declared() const;
  // In words: which laws fail, and which are broken as they must.
  [[nodiscard]] std::string remark() const;
};

// The laws of one step: order, symplectic form, reversal. `reference` are those of
// audit_reference().
MethodAudit audit_step(const AuditSubject& subject,
                       const Method& method,
                       const ReferenceRun& reference);

// The same and the laws of the long run: energy and constraints.
MethodAudit audit_method(const AuditSubject& subject,
                         const Method& method,
                         const ReferenceRun& reference,
                         const Progress& progress);

// Whether the slope tells the order: at least three points on a line, of an order that leaves some
// in the range of double.
bool resolved(const OrderLaw& law, int order);

}  // namespace carnot::apps
