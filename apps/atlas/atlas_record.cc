#include "atlas/atlas_record.h"

#include <cmath>
#include <utility>

#include "run/geodesic_text.h"

namespace carnot::apps {

namespace {

// Which problem it is.
Json head_of(long index, const Ends& ends) {
  Json json;
  json["index"] = index;
  json["from"] = end_json(ends.from, ends.free_from);
  json["to"] = end_json(ends.to, ends.free_to);
  json["time"] = ends.time;
  return json;
}

}  // namespace

Json atlas_record(long index,
                  const AtlasProblem& problem,
                  const std::vector<std::string>& parameters,
                  const GeodesicReport& report) {
  const Ends& ends = problem.ends;
  Json json = head_of(index, ends);
  if (!parameters.empty()) {
    json["parameters"] = Json::object();
    for (const std::string& name : parameters) {
      json["parameters"][name] = problem.parameters.at(name);
    }
  }
  const bool found = !report.geodesics.empty();
  json["status"] = found ? "converged" : "not_converged";
  json["reason"] = found ? Json(nullptr) : Json(name_of(report.reason));
  json["message"] = report.message;
  json["geodesics"] = Json::array();
  for (const Geodesic& geodesic : report.geodesics) {
    Json one = geodesic_json(geodesic, ends, json["geodesics"].size() + 1);
    if (!geodesic.trajectory.t.empty()) one["trajectory"] = trajectory_json(geodesic.trajectory);
    json["geodesics"].push_back(std::move(one));
  }
  json["starts"] = report.starts;
  json["missed_estimate"] = or_null(report.missed_estimate);
  json["seconds"] = report.elapsed_seconds;
  return json;
}

Json field_record(long index, const AtlasProblem& problem, const Field& field) {
  const bool found = field.reason[index] == Reason::kNone;
  Json json = head_of(index, problem.ends);
  json["status"] = found ? "converged" : "not_converged";
  json["reason"] = found ? Json(nullptr) : Json(name_of(field.reason[index]));
  json["message"] = "";
  json["geodesics"] = Json::array();
  if (found) {
    const double* const p0 = field.p0.data() + index * field.dof;
    Geodesic geodesic;
    geodesic.p0.assign(p0, p0 + field.dof);
    geodesic.action = field.action[index];
    // The action is that of constant speed.
    geodesic.length = std::sqrt(2 * geodesic.action * problem.ends.time);
    geodesic.verification = field.verification[index];
    geodesic.endpoint_error = geodesic.knot_defect = field.error[index];
    Json one;
    add_extremal(geodesic, problem.ends, one);
    one.erase("lambda0");  // not kept
    one["label"] = name_of(field.label[index]);
    json["geodesics"].push_back(std::move(one));
  }
  json["starts"] = nullptr;
  json["missed_estimate"] = nullptr;
  json["seconds"] = nullptr;
  return json;
}

}  // namespace carnot::apps
