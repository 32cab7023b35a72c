#include "run/geodesic_text.h"

#include "text/text_table.h"

namespace carnot::apps {
namespace {

Json limits_json(const Geodesic& geodesic) {
  Json list = Json::array();
  for (const LimitReport& limit : geodesic.limits) {
    Json json;
    json["name"] = limit.name;
    json["lowest_slack"] = limit.lowest_slack;
    json["active"] = Json::array();
    for (const auto& [begin, end] : limit.active) json["active"].push_back({begin, end});
    json["largest_multiplier"] = limit.largest_multiplier;
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace

const char* name_of(Label label) {
  switch (label) {
    case Label::kLocallyMinimal:
      return "locally-minimal";
    case Label::kConjugatePassed:
      return "conjugate-passed";
    case Label::kSingular:
      return "singular";
    case Label::kUnknown:
      return "unknown";
    case Label::kAbnormal:
      return "abnormal";
    case Label::kNotMinimal:
      return "not-minimal";
  }
  return "unknown";
}

const char* name_of(Verification verification) {
  switch (verification) {
    case Verification::kSingle:
      return "single";
    case Verification::kKnots:
      return "knots";
    case Verification::kGrid:
      return "grid";
  }
  return "";
}

Json problem_json(const std::vector<std::string>& arguments, const Run& run, const Ends& ends) {
  Json json = result_head(arguments);
  json["scene"] = run.entry->info.name;
  json["parameters"] = parameters_json(run);
  json["from"] = end_json(ends.from, ends.free_from);
  json["to"] = end_json(ends.to, ends.free_to);
  json["time"] = ends.time;
  json["method"] = run.method.name;
  return json;
}

void add_extremal(const Geodesic& geodesic, const Ends& ends, Json& json) {
  const bool single = geodesic.verification == Verification::kSingle;
  const bool knots = geodesic.verification == Verification::kKnots;
  const bool driven = geodesic.label != Label::kAbnormal;
  json["p0"] = driven ? Json(geodesic.p0) : Json(nullptr);
  json["lambda0"] = driven ? Json(geodesic.lambda0) : Json(nullptr);
  json["action"] = geodesic.action;
  json["length"] = or_null(geodesic.length);
  json["verification"] = name_of(geodesic.verification);
  json["endpoint_error"] = single ? Json(geodesic.endpoint_error) : Json(nullptr);
  json["knot_defect"] = knots ? Json(geodesic.knot_defect) : Json(nullptr);
  if (!single && !knots) json["grid_error"] = geodesic.grid_error;
  if (!has_free(ends)) return;
  json["from_found"] = geodesic.from;
  json["to_found"] = geodesic.to;
  json["transversality_error"] = geodesic.transversality_error;
}

void add_limits(const Geodesic& geodesic, const Ends& ends, Json& json) {
  if (ends.limits.empty()) return;
  json["limits"] = limits_json(geodesic);
  json["limit_violation"] = geodesic.limit_violation;
}

Json geodesic_json(const Geodesic& geodesic, const Ends& ends, std::size_t rank) {
  Json json;
  add_extremal(geodesic, ends, json);
  json["constraint_error"] = geodesic.constraint_error;
  json["energy_drift"] = geodesic.energy_drift;
  json["conjugate_times"] = or_null(geodesic.conjugate_times);
  json["label"] = name_of(geodesic.label);
  json["abnormal"] = or_null(geodesic.abnormal);
  json["morse_index"] = or_null(geodesic.morse_index);
  json["family_dimension"] = or_null(geodesic.family_dimension);
  json["rank_in_list"] = rank;
  json["hits"] = geodesic.hits;
  if (!geodesic.windings.empty()) json["windings"] = geodesic.windings;
  for (const auto& [name, value] : geodesic.extremes) json[name] = value;
  add_limits(geodesic, ends, json);
  return json;
}

std::vector<std::string> geodesic_cells(const Geodesic& geodesic) {
  const bool single = geodesic.verification == Verification::kSingle;
  const bool knots = geodesic.verification == Verification::kKnots;
  const double error = single  ? geodesic.endpoint_error
                       : knots ? geodesic.knot_defect
                               : geodesic.grid_error;
  return {text_number(geodesic.action, 10),
          geodesic.length ? text_number(*geodesic.length, 10) : "-",
          text_number(error, 2) + (single  ? ""
                                   : knots ? " (knots)"
                                           : " (grid)"),
          name_of(geodesic.label)};
}

}  // namespace carnot::apps
