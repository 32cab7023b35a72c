#include "atlas/atlas_record.h"

#include "run/geodesic_text.h"

namespace carnot::apps {

Json atlas_record(long index,
                  const AtlasProblem& problem,
                  const std::vector<std::string>& parameters,
                  const GeodesicReport& report) {
  const Ends& ends = problem.ends;
  Json json;
  json["index"] = index;
  json["from"] = end_json(ends.from, ends.free_from);
  json["to"] = end_json(ends.to, ends.free_to);
  json["time"] = ends.time;
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

}  // namespace carnot::apps
