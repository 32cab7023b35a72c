#include "geodesic/geodesic_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "carnot/plots/curves_of.h"
#include "run/geodesic_text.h"
#include "text/csv_text.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

Json report_json(const GeodesicRequest& request,
                 const GeodesicReport& report,
                 const std::vector<std::string>& arguments) {
  const Run& run = request.run;
  Json geodesics = Json::array();
  for (const Geodesic& geodesic : report.geodesics) {
    Json one = geodesic_json(geodesic, request.ends, geodesics.size() + 1);
    if (!run.no_trajectory) one["trajectory"] = trajectory_json(geodesic.trajectory);
    geodesics.push_back(std::move(one));
  }
  Json json = problem_json(arguments, run, request.ends);
  json["status"] = report.status == GeodesicStatus::kConverged ? "converged" : "not_converged";
  const bool found = report.reason == Reason::kNone;
  json["reason"] = found ? Json(nullptr) : Json(name_of(report.reason));
  json["message"] = report.message;
  json["geodesics"] = std::move(geodesics);
  json["starts"] = report.starts;
  json["converged_starts"] = report.converged_starts;
  json["distinct_hit"] = report.distinct_hit;
  json["missed_estimate"] = or_null(report.missed_estimate);
  json["elapsed_seconds"] = report.elapsed_seconds;
  return json;
}

// "largest_steering_angle" as a column of a table for people.
std::string column_title(const Extreme& extreme) {
  std::string title = extreme.name;
  std::replace(title.begin(), title.end(), '_', ' ');
  return extreme.unit.empty() ? title : title + " [" + extreme.unit + "]";
}

std::vector<std::string> header_row(const SceneInfo& info, bool limited) {
  std::vector<std::string> row{"#", "action", "length", "error", "label"};
  for (const Extreme& extreme : info.extremes) row.push_back(column_title(extreme));
  if (limited) row.emplace_back("slack");
  row.emplace_back("p0");
  return row;
}

std::vector<std::string> geodesic_row(const Geodesic& geodesic,
                                      const SceneInfo& info,
                                      bool limited,
                                      std::size_t rank) {
  std::vector<std::string> row = geodesic_cells(geodesic);
  row.insert(row.begin(), std::to_string(rank));
  for (const Extreme& extreme : info.extremes) {
    std::string text = "-";
    for (const auto& [name, value] : geodesic.extremes) {
      if (name == extreme.name) text = text_number(value);
    }
    row.push_back(text);
  }
  if (limited) {
    double slack = std::numeric_limits<double>::infinity();
    for (const LimitReport& limit : geodesic.limits) slack = std::min(slack, limit.lowest_slack);
    row.push_back(text_number(slack, 2));
  }
  row.push_back(geodesic.label == Label::kAbnormal ? "-" : text_vector(geodesic.p0, 8));
  return row;
}

std::string table(const GeodesicReport& report, const SceneInfo& info, bool limited) {
  constexpr std::size_t kMostRows = 50;
  const std::size_t found = report.geodesics.size();
  std::vector<std::vector<std::string>> rows{header_row(info, limited)};
  for (std::size_t i = 0; i < std::min(found, kMostRows); ++i) {
    rows.push_back(geodesic_row(report.geodesics[i], info, limited, i + 1));
  }
  const std::string text = text_table(rows);
  return found > kMostRows ? text + fmt::format("... {} more (see --json)\n", found - kMostRows)
                           : text;
}

std::string report_text(const GeodesicRequest& request, const GeodesicReport& report) {
  const Run& run = request.run;
  const Ends& ends = request.ends;
  const std::size_t found = report.geodesics.size();
  std::string text = fmt::format("{}: {} geodesic{} from {} to {} in time {:g}\n",
                                 run.entry->info.name,
                                 found,
                                 found == 1 ? "" : "s",
                                 end_text(ends.from, ends.free_from),
                                 end_text(ends.to, ends.free_to),
                                 ends.time);
  if (found > 0) text += '\n' + table(report, run.entry->info, !ends.limits.empty()) + '\n';
  text += fmt::format("{} of {} starts converged, {}, {:.3g} s\n",
                      report.converged_starts,
                      report.starts,
                      run.method.name,
                      report.elapsed_seconds);
  if (!report.message.empty()) text += report.message + '\n';
  return text;
}

}  // namespace

Result geodesic_result(const GeodesicRequest& request,
                       const GeodesicReport& report,
                       const std::vector<std::string>& arguments) {
  const Dynamics& dynamics = request.run.dynamics;
  Result result;
  result.delivered = report.status == GeodesicStatus::kConverged && !report.geodesics.empty();
  result.message = "no geodesic was found: " + report.message;
  result.json = report_json(request, report, arguments);
  result.text = [&] { return report_text(request, report); };
  result.csv = [&] {
    std::vector<const Trajectory*> trajectories;
    for (const Geodesic& geodesic : report.geodesics) trajectories.push_back(&geodesic.trajectory);
    return csv_text(dynamics.info, dynamics.multipliers, trajectories);
  };
  result.draw = [&](const std::string& file) {
    SceneInfo info = dynamics.info;
    info.limits = request.ends.limits;
    return plots::write_figure(
        file, info, plots::curves_of(report.geodesics), request.run.destination.figure);
  };
  return result;
}

}  // namespace carnot::apps
