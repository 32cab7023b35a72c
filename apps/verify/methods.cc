// carnot methods: the integrators that --method names, declared and measured.
#include <CLI/CLI.hpp>
#include <memory>

#include "catalogue/scene_choice.h"
#include "run/deferred.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/text_table.h"
#include "verify/audit_text.h"

namespace carnot::apps {
namespace {

constexpr const char* kMethodsFooter = R"(
The number in a name is the order. What is measured, on vehicle-cosine, or rod-skate for rattle*:
the order as a slope (in parentheses where double does not resolve it), the defect M'JM - J of the
symplectic form, and that of reversal, h after -h. A star marks a law that the method breaks and
does not declare. `carnot verify` measures more, on scenes of every kind.

Examples
  carnot methods
  carnot methods --json

Exit status: 0 success, 1 a file could not be written, 2 bad input, 130 interrupted.)";

constexpr const char* kFreeScene = "vehicle-cosine";
constexpr const char* kHolonomicScene = "rod-skate";

// One row per method, in the order of methods().
std::vector<MethodAudit> measure_methods() {
  std::vector<MethodAudit> rows(methods().size());
  for (const char* name : {kFreeScene, kHolonomicScene}) {
    const SceneEntry& entry = find_scene(name);
    const AuditSubject subject = *audit_subject(entry);
    const ReferenceRun reference = audit_reference(subject);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Method& method = methods()[i];
      const bool here = (method.family == kRattleFamily) == (entry.holonomic > 0);
      if (here) rows[i] = audit_step(subject, method, reference);
    }
  }
  return rows;
}

Json methods_json(const std::vector<MethodAudit>& rows) {
  Json list = Json::array();
  for (const MethodAudit& row : rows) {
    list.push_back({{"name", row.method.name},
                    {"order", row.method.order},
                    {"stages", row.method.stages},
                    {"family", row.method.family},
                    {"symplectic", row.method.symplectic},
                    {"symmetric", row.method.symmetric},
                    {"scene", row.scene},
                    {"measured_order", row.order.fit.slope},
                    {"order_verdict", describe(row.order_verdict)},
                    {"symplecticity_defect", row.symplecticity},
                    {"reversibility_defect", row.reversal.adjoint},
                    {"summary", row.method.summary}});
  }
  return list;
}

std::string methods_text(const std::vector<MethodAudit>& rows) {
  std::vector<std::vector<std::string>> cells{
      {"method", "order", "measured", "stages", "M'JM-J", "reversal", "summary"}};
  for (const MethodAudit& row : rows) {
    cells.push_back({row.method.name,
                     std::to_string(row.method.order),
                     order_text(row),
                     std::to_string(row.method.stages),
                     defect_text(row.symplecticity, row.symplecticity_verdict),
                     defect_text(row.reversal.adjoint, row.reversal_verdict),
                     row.method.family + ": " + row.method.summary});
  }
  return text_table(cells);
}

}  // namespace

void add_methods(CLI::App& app, Invocation& invocation) {
  auto destination = std::make_shared<Destination>();
  CLI::App& methods = add_deferred_command(app, "methods");
  add_table_options(methods, *destination);
  methods.footer(kMethodsFooter);
  methods.callback([destination, &invocation] {
    check_table_output(*destination);
    const std::vector<MethodAudit> rows = measure_methods();
    Result result;
    result.json = result_head(invocation.arguments);
    result.json["methods"] = methods_json(rows);
    result.text = [rows] { return methods_text(rows); };
    invocation.exit_status = deliver(result, *destination);
  });
}

}  // namespace carnot::apps
