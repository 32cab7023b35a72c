#include "verify/audit_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "text/text_table.h"

namespace carnot::apps {
namespace {

std::string plain(double value, int digits) {
  return std::isnan(value) ? "-" : text_number(value, digits);
}

// The largest of those measured.
double worse(double a, double b) { return std::isnan(b) || a >= b ? a : b; }

std::string signed_text(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:+.3f}", value);
}

std::string constraint_text(const MethodAudit& audit) {
  if (audit.constraint_verdict == Verdict::kNotAsked) return "-";
  return defect_text(worse(audit.energy.constraint_error, audit.energy.holonomic_error),
                     audit.constraint_verdict);
}

std::vector<std::string> energy_cells(const MethodAudit& audit) {
  if (audit.energy_verdict == Verdict::kNotAsked) return {"-", "-", "-", "-"};
  return {defect_text(audit.energy.largest, audit.energy_verdict),
          signed_text(audit.energy.correlation),
          signed_text(audit.energy.drift),
          plain(audit.energy.growth, 3)};
}

}  // namespace

std::string order_text(const MethodAudit& audit) {
  if (std::isnan(audit.order.fit.slope)) return "-";
  const std::string slope = fmt::format("{:.2f}", audit.order.fit.slope);
  return audit.order_verdict == Verdict::kOpen ? "(" + slope + ")" : slope;
}

std::string defect_text(double defect, Verdict verdict) {
  const bool broken = verdict == Verdict::kBreaks || verdict == Verdict::kFails;
  return plain(defect, 2) + (broken ? "*" : "");
}

std::string subject_text(const AuditSubject& subject) {
  std::string parameters;
  for (const auto& [name, value] : subject.parameters) {
    parameters += fmt::format(", {} = {}", name, text_number(value));
  }
  const std::string energy =
      subject.energy_step > 0
          ? fmt::format(
                "H over {} steps of {}", subject.energy_steps, text_number(subject.energy_step))
          : "H not asked: the motion is not known to be bounded";
  return fmt::format(
      "{} ({}){}\n  (q, p) = {}; order over T = {}, symplecticity and reversal with "
      "h = {}, {}\n",
      subject.entry->info.name,
      subject.entry->info.kind,
      parameters,
      text_vector(subject.start.z),
      text_number(subject.duration),
      text_number(subject.step),
      energy);
}

Json subject_json(const AuditSubject& subject, const ReferenceRun& reference) {
  const auto middle = subject.start.z.begin() + subject.entry->dof;
  Json parameters = Json::object();
  for (const auto& [name, value] : subject.parameters) parameters[name] = value;
  return {{"scene", subject.entry->info.name},
          {"kind", subject.entry->info.kind},
          {"parameters", parameters},
          {"start_time", subject.start.t},
          {"q", std::vector<double>(subject.start.z.begin(), middle)},
          {"p", std::vector<double>(middle, subject.start.z.end())},
          {"order_time", subject.duration},
          {"reference_error", reference.error},
          {"step", subject.step},
          {"energy_step", subject.energy_step > 0 ? Json(subject.energy_step) : Json(nullptr)},
          {"energy_steps", subject.energy_steps}};
}

std::string audit_table(const std::vector<MethodAudit>& rows) {
  std::vector<std::vector<std::string>> cells{{"method",
                                               "order",
                                               "measured",
                                               "M'JM-J",
                                               "reversal",
                                               "H error",
                                               "correlation",
                                               "drift",
                                               "growth",
                                               "constraints",
                                               "verdict"}};
  for (const MethodAudit& audit : rows) {
    std::vector<std::string> row{audit.method.name,
                                 std::to_string(audit.method.order),
                                 order_text(audit),
                                 defect_text(audit.symplecticity, audit.symplecticity_verdict),
                                 defect_text(worse(audit.reversal.adjoint, audit.reversal.mirrored),
                                             audit.reversal_verdict)};
    for (std::string& cell : energy_cells(audit)) row.push_back(std::move(cell));
    row.push_back(constraint_text(audit));
    row.push_back(audit.remark());
    cells.push_back(std::move(row));
  }
  return text_table(cells);
}

Json audit_json(const MethodAudit& audit) {
  const Method& method = audit.method;
  return {{"method", method.name},
          {"family", method.family},
          {"scene", audit.scene},
          {"order", method.order},
          {"measured_order", audit.order.fit.slope},
          {"order_standard_error", audit.order.fit.standard_error},
          {"order_correlation", audit.order.fit.correlation},
          {"order_points", audit.order.fit.points},
          {"order_steps", audit.order.steps},
          {"order_errors", audit.order.errors},
          {"order_verdict", describe(audit.order_verdict)},
          {"symplectic", method.symplectic},
          {"symplecticity_defect", audit.symplecticity},
          {"symplecticity_verdict", describe(audit.symplecticity_verdict)},
          {"symmetric", method.symmetric},
          {"reversibility_defect", audit.reversal.adjoint},
          {"mirrored_defect", audit.reversal.mirrored},
          {"reversibility_verdict", describe(audit.reversal_verdict)},
          {"energy_steps", audit.energy.report.steps},
          {"energy_error", audit.energy.largest},
          {"energy_correlation", audit.energy.correlation},
          {"energy_drift", audit.energy.drift},
          {"energy_growth", audit.energy.growth},
          {"energy_verdict", describe(audit.energy_verdict)},
          {"constraint_error", audit.energy.constraint_error},
          {"holonomic_error", audit.energy.holonomic_error},
          {"midpoint_constraint_error", audit.midpoint_constraint},
          {"constraints_verdict", describe(audit.constraint_verdict)},
          {"as_declared", audit.as_declared()},
          {"remark", audit.remark()}};
}

}  // namespace carnot::apps
