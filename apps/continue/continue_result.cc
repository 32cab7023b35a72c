#include "continue/continue_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "carnot/plots/curve.h"
#include "run/geodesic_text.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

const char* status_name(ContinuationStatus status) {
  switch (status) {
    case ContinuationStatus::kReached:
      return "reached";
    case ContinuationStatus::kReturned:
      return "returned";
    case ContinuationStatus::kClosed:
      return "closed";
    case ContinuationStatus::kMaxPoints:
      return "max_points";
    case ContinuationStatus::kStepTooSmall:
      return "step_too_small";
    case ContinuationStatus::kSingular:
      return "singular_start";
    case ContinuationStatus::kNotConverged:
      return "not_converged";
    case ContinuationStatus::kInterrupted:
      return "interrupted";
  }
  return "";
}

bool is_end(const Along& along) {
  return along.kind == Along::Kind::kTarget || along.kind == Along::Kind::kStart;
}

bool is_vector(const Along& along) { return is_end(along) || along.start.size() > 1; }

Json value_json(const Along& along, const std::vector<double>& value) {
  return is_vector(along) ? Json(value) : Json(value.front());
}

// What the numbers of a limit or a disc are called, besides the name of what changes.
std::vector<std::string> parts_of(const Along& along) {
  if (along.start.size() == 1) return {""};
  if (along.kind == Along::Kind::kLimit) return {"_lower", "_upper"};
  return {"_x", "_y", "_radius"};
}

Json point_json(const ContinueRequest& request, const ContinuationPoint& point) {
  const Along& along = request.along;
  const Geodesic& geodesic = point.geodesic;
  Json json;
  json["branch"] = point.branch;
  json["s"] = point.s;
  json["value"] = value_json(along, along.value(point.s));
  add_extremal(geodesic, request.ends, json);
  json["morse_index"] = or_null(geodesic.morse_index);
  json["label"] = name_of(geodesic.label);
  add_limits(geodesic, request.ends, json);
  return json;
}

Json changes_json(const Along& along, const std::vector<ContactChange>& changes) {
  Json list = Json::array();
  for (const ContactChange& change : changes) {
    list.push_back({{"s", change.s},
                    {"s_error", change.error},
                    {"value", value_json(along, along.value(change.s))},
                    {"before", change.before},
                    {"after", change.after},
                    {"action", change.action}});
  }
  return list;
}

Json special_json(const Along& along, const std::vector<SpecialPoint>& points) {
  Json list = Json::array();
  for (const SpecialPoint& point : points) {
    Json json;
    json["branch"] = point.branch;
    json["s"] = point.s;
    json["value"] = value_json(along, along.value(point.s));
    json["p0"] = point.p0;
    json["action"] = point.action;
    list.push_back(std::move(json));
  }
  return list;
}

Json report_json(const ContinueRequest& request,
                 const ContinuationReport& report,
                 const std::vector<std::string>& arguments) {
  const Along& along = request.along;
  Json points = Json::array();
  for (const ContinuationPoint& point : report.points) points.push_back(point_json(request, point));
  Json branches = Json::array();
  for (const ContinuationStatus end : report.branch_ends) branches.push_back(status_name(end));
  Json json = problem_json(arguments, request.run, request.ends);
  json["along"] = {{"name", along.name},
                   {"start", value_json(along, along.start)},
                   {"end", value_json(along, along.end)}};
  json["status"] = status_name(report.status);
  json["message"] = report.message;
  json["points"] = std::move(points);
  json["folds"] = special_json(along, report.folds);
  json["branch_points"] = special_json(along, report.branch_points);
  json["branch_status"] = std::move(branches);
  if (!request.ends.limits.empty()) {
    json["contact_changes"] = changes_json(along, report.contact_changes);
  }
  json["elapsed_seconds"] = report.elapsed_seconds;
  return json;
}

std::string csv_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.17g}", *value) : "";
}

// A header may hold the formula of a limit.
std::string csv_field(const std::string& text) {
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

std::string report_csv(const ContinueRequest& request, const ContinuationReport& report) {
  const auto& coordinates = request.run.entry->info.configuration;
  std::string out = "branch,s";
  if (is_end(request.along)) {
    for (const Coordinate& coordinate : coordinates) {
      out += fmt::format(",{}_{}", request.along.name, coordinate.name);
    }
  } else {
    for (const std::string& part : parts_of(request.along)) {
      out += "," + csv_field(request.along.name + part);
    }
  }
  out += ",action,length,endpoint_error,knot_defect,morse_index,label";
  for (const Coordinate& coordinate : coordinates) out += ",p_" + coordinate.name;
  out += '\n';
  for (const ContinuationPoint& point : report.points) {
    const Geodesic& geodesic = point.geodesic;
    const bool single = geodesic.verification == Verification::kSingle;
    out += fmt::format("{},{:.17g}", point.branch, point.s);
    for (const double x : request.along.value(point.s)) out += fmt::format(",{:.17g}", x);
    out += fmt::format(",{:.17g},{},{},{},{},{}",
                       geodesic.action,
                       csv_number(geodesic.length),
                       single ? csv_number(geodesic.endpoint_error) : "",
                       single ? "" : csv_number(geodesic.knot_defect),
                       geodesic.morse_index ? std::to_string(*geodesic.morse_index) : "",
                       name_of(geodesic.label));
    for (const double p : geodesic.p0) out += fmt::format(",{:.17g}", p);
    out += '\n';
  }
  return out;
}

std::string value_text(const Along& along, double s, int digits) {
  const std::vector<double> value = along.value(s);
  return is_vector(along) ? text_vector(value, digits) : text_number(value.front(), digits);
}

std::vector<std::string> point_row(const Along& along, const ContinuationPoint& point) {
  std::vector<std::string> row = geodesic_cells(point.geodesic);
  row.insert(row.begin(),
             {std::to_string(point.branch), text_number(point.s), value_text(along, point.s, 6)});
  row.push_back(text_vector(point.geodesic.p0, 8));
  return row;
}

std::string table(const Along& along, const ContinuationReport& report) {
  constexpr std::size_t kMostRows = 30;
  std::vector<std::vector<std::string>> rows{
      {"branch", "s", along.name, "action", "length", "error", "label", "p0"}};
  for (const std::size_t i : plots::spread(report.points.size(), kMostRows)) {
    rows.push_back(point_row(along, report.points[i]));
  }
  const std::size_t left_out = report.points.size() + 1 - rows.size();
  std::string text = text_table(rows);
  if (left_out > 0) text += fmt::format("... {} more in between (see --json)\n", left_out);
  return text;
}

std::string special_text(const char* name,
                         const Along& along,
                         const std::vector<SpecialPoint>& points) {
  std::string text;
  for (const SpecialPoint& point : points) {
    text += fmt::format("{} at {} = {}, action {}, p0 {}\n",
                        name,
                        along.name,
                        value_text(along, point.s, 10),
                        text_number(point.action, 10),
                        text_vector(point.p0, 8));
  }
  return text;
}

// "steering (3 times), hinge"
std::string contacts_text(const std::vector<std::string>& contacts) {
  if (contacts.empty()) return "no limit";
  std::vector<std::string> parts;
  for (auto first = contacts.begin(); first != contacts.end();) {
    const auto last =
        std::find_if(first, contacts.end(), [&](const auto& name) { return name != *first; });
    const auto times = last - first;
    parts.push_back(times > 1 ? fmt::format("{} ({} times)", *first, times) : *first);
    first = last;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string changes_text(const Along& along, const std::vector<ContactChange>& changes) {
  std::string text;
  for (const ContactChange& change : changes) {
    text += fmt::format("at {} = {} it goes over from {} to {}, action {}\n",
                        along.name,
                        value_text(along, change.s, 6),
                        contacts_text(change.before),
                        contacts_text(change.after),
                        text_number(change.action, 10));
  }
  return text;
}

std::string report_text(const ContinueRequest& request, const ContinuationReport& report) {
  const Along& along = request.along;
  const Run& run = request.run;
  std::string text = fmt::format("{}: {} points along {} from {} to {}: {}\n",
                                 run.entry->info.name,
                                 report.points.size(),
                                 along.name,
                                 value_text(along, 0, 6),
                                 value_text(along, 1, 6),
                                 status_name(report.status));
  if (!report.points.empty()) text += '\n' + table(along, report) + '\n';
  text += special_text("fold", along, report.folds);
  text += special_text("branch point", along, report.branch_points);
  text += changes_text(along, report.contact_changes);
  for (std::size_t i = 0; i < report.branch_ends.size(); ++i) {
    text += fmt::format("branch {}: {}\n", i + 1, status_name(report.branch_ends[i]));
  }
  text += fmt::format("{}, {:.3g} seconds\n", run.method.name, report.elapsed_seconds);
  if (!report.message.empty()) text += report.message + '\n';
  return text;
}

}  // namespace

Result continue_result(const ContinueRequest& request,
                       const ContinuationReport& report,
                       const std::vector<std::string>& arguments) {
  Result result;
  result.delivered = report.complete() || report.status == ContinuationStatus::kMaxPoints;
  result.message = report.message;
  result.json = report_json(request, report, arguments);
  result.csv = [&] { return report_csv(request, report); };
  result.text = [&] { return report_text(request, report); };
  result.draw = [&](const std::string& file) { return draw_continuation(file, request, report); };
  return result;
}

}  // namespace carnot::apps
