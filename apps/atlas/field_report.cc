#include "atlas/field_report.h"

#include <fmt/format.h>

namespace carnot::apps {

Json field_json(const Field& field) {
  return {{"searches", field.searches},
          {"pushes", field.pushes},
          {"improved", field.improved},
          {"tangent_flows", field.flows},
          {"sweeps", field.sweeps},
          {"settled", field.settled},
          {"unkept", field.unkept},
          {"triangles", field.triangles},
          {"violations", field.violations},
          {"checked", field.checked},
          {"lower", field.lower},
          {"bound", field.bound}};
}

std::string field_text(const Field& field) {
  std::string text = fmt::format(
      "{} searches, the rest from neighbours; {} promises of less were not kept\n"
      "of {} triangles between neighbours {} are violated\n"
      "of {} points searched again {} had less: at most {:.2g} of all, with 95 % confidence\n",
      field.searches,
      field.unkept,
      field.triangles,
      field.violations,
      field.checked,
      field.lower,
      field.bound);
  if (!field.settled) {
    text += fmt::format(
        "values still fell when the sweeps were ended, after {} of them: a finer grid may settle\n",
        field.sweeps);
  }
  return text;
}

}  // namespace carnot::apps
