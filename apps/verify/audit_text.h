// The audit as a table for people and as JSON.
#pragma once

#include <string>
#include <vector>

#include "text/json_text.h"
#include "verify/method_audit.h"

namespace carnot::apps {

// "4.02"; in parentheses where double does not resolve the order, "-" where nothing was measured.
std::string order_text(const MethodAudit& audit);

// "3.1e-17", with a star where the law is broken or fails; "-" where it was not measured.
std::string defect_text(double defect, Verdict verdict);

// Where and how the scene was audited.
std::string subject_text(const AuditSubject& subject);
Json subject_json(const AuditSubject& subject, const ReferenceRun& reference);

std::string audit_table(const std::vector<MethodAudit>& rows);
Json audit_json(const MethodAudit& audit);

}  // namespace carnot::apps
