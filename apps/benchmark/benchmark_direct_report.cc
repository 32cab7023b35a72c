#include "benchmark/benchmark_direct_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_report.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

using Cells = std::vector<std::vector<std::string>>;

bool has_direct(const std::vector<DirectRow>& rows) {
  return std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.direct; });
}

// The difference of two actions over their size.
std::optional<double> difference(const DirectRow& row) {
  if (!row.direct || !row.direct->action) return std::nullopt;
  return std::abs(row.own.action - *row.direct->action) / std::abs(row.own.action);
}

bool with_limits(const std::vector<DirectRow>& rows) {
  return !rows.empty() && !rows.front().problem.drift;
}

Cells own_table(const std::vector<DirectRow>& rows) {
  const bool limits = with_limits(rows);
  Cells cells{{"problem", "scene", "action", "verified"}};
  for (const char* title : limits ? std::vector{"contacts", "violation"} : std::vector{"time"}) {
    cells[0].emplace_back(title);
  }
  cells[0].insert(cells[0].end(), {"label", "CPU s"});
  for (const DirectRow& row : rows) {
    const OwnAnswer& own = row.own;
    std::vector<std::string> cell{row.problem.name,
                                  row.problem.scene,
                                  own.solved ? text_number(own.action, 12) : "-",
                                  own.verification};
    if (limits) {
      cell.push_back(std::to_string(own.contacts));
      cell.push_back(text_number(own.violation, 2));
    } else {
      cell.push_back(text_number(row.problem.time, 3));
    }
    cell.insert(cell.end(), {own.label, text_number(own.seconds, 3)});
    cells.push_back(std::move(cell));
  }
  return cells;
}

Cells direct_table(const std::vector<DirectRow>& rows) {
  const bool limits = with_limits(rows);
  Cells cells{{"problem", "limit of grids", "known to", "difference"}};
  if (limits) cells[0].emplace_back("violation");
  cells[0].insert(cells[0].end(), {"CPU s", "blind starts solved", "at the least", "CPU s each"});
  for (const DirectRow& row : rows) {
    if (!row.direct) continue;
    const DirectAnswer& direct = *row.direct;
    const auto apart = difference(row);
    std::vector<std::string> cell{row.problem.name,
                                  direct.action ? text_number(*direct.action, 12) : "-",
                                  direct.action ? text_number(direct.action_error, 2) : "-",
                                  apart ? text_number(*apart, 2) : "-"};
    if (limits) cell.push_back(text_number(direct.violation, 2));
    cell.insert(cell.end(),
                {text_number(direct.seconds, 3),
                 fmt::format("{} of {}", direct.solved, direct.starts),
                 std::to_string(direct.least_found),
                 text_number(direct.seconds_per_start, 3)});
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::string direct_title(const std::vector<DirectRow>& rows) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.direct; });
  return fmt::format(
      "{} on the midpoint grid{}: from carnot's path on three grids, and from blind starts",
      found->direct->solver,
      with_limits(rows) ? ", which keeps to the limits at its nodes" : "");
}

Json direct_json(const DirectRow& row) {
  if (!row.direct) return nullptr;
  const DirectAnswer& direct = *row.direct;
  Json json{{"solver", direct.solver},
            {"action", or_null(direct.action)},
            {"action_error", direct.action ? Json(direct.action_error) : Json(nullptr)},
            {"difference", or_null(difference(row))}};
  if (!row.problem.drift) json["violation"] = direct.violation;
  json["seconds"] = direct.seconds;
  json["starts"] = direct.starts;
  json["solved"] = direct.solved;
  json["least_found"] = direct.least_found;
  json["seconds_per_start"] = direct.seconds_per_start;
  return json;
}

}  // namespace

void add_direct_json(const std::vector<DirectRow>& rows, Json& json) {
  Json list = Json::array();
  for (const DirectRow& row : rows) {
    const DirectProblem& problem = row.problem;
    Json entry{{"problem", problem.name},
               {"scene", problem.scene},
               {"from", problem.from},
               {"to", problem.to}};
    if (problem.drift) {
      entry["time"] = problem.time;
    } else {
      entry["limits"] = problem.asked.limits;
      entry["discs"] = problem.asked.discs;
    }
    entry["action"] = row.own.solved ? Json(row.own.action) : Json(nullptr);
    entry["verification"] = row.own.verification;
    if (!problem.drift) {
      entry["contacts"] = row.own.contacts;
      entry["violation"] = row.own.violation;
    }
    entry["label"] = row.own.label;
    entry["seconds"] = row.own.seconds;
    entry["direct"] = direct_json(row);
    list.push_back(std::move(entry));
  }
  json["rows"] = std::move(list);
}

std::string direct_text(const std::vector<DirectRow>& rows) {
  std::string text = text_table(own_table(rows));
  if (has_direct(rows)) {
    text += fmt::format("\n{}\n\n{}", direct_title(rows), text_table(direct_table(rows)));
  }
  return text;
}

std::string direct_markdown(const std::vector<DirectRow>& rows,
                            const std::vector<std::string>& arguments) {
  std::string text = fmt::format("{}\n## {}\n\n{}",
                                 markdown_head(arguments),
                                 with_limits(rows) ? "Limits" : "Drift",
                                 markdown_table(own_table(rows)));
  if (has_direct(rows)) {
    text += fmt::format("\n{}.\n\n{}", direct_title(rows), markdown_table(direct_table(rows)));
  }
  return text;
}

}  // namespace carnot::apps
