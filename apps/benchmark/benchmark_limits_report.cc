#include "benchmark/benchmark_limits_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmark/benchmark_report.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

using Cells = std::vector<std::vector<std::string>>;

bool has_direct(const std::vector<LimitsRow>& rows) {
  return std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.direct; });
}

// The difference of two actions over their size.
std::optional<double> difference(const LimitsRow& row) {
  if (!row.direct || !row.direct->action) return std::nullopt;
  return std::abs(row.own.action - *row.direct->action) / std::abs(row.own.action);
}

Cells own_table(const std::vector<LimitsRow>& rows) {
  Cells cells{
      {"problem", "scene", "action", "verified", "contacts", "violation", "label", "CPU s"}};
  for (const LimitsRow& row : rows) {
    const LimitsAnswer& own = row.own;
    cells.push_back({row.problem.name,
                     row.problem.scene,
                     own.solved ? text_number(own.action, 12) : "-",
                     own.verification,
                     std::to_string(own.contacts),
                     text_number(own.violation, 2),
                     own.label,
                     text_number(own.seconds, 3)});
  }
  return cells;
}

Cells direct_table(const std::vector<LimitsRow>& rows) {
  Cells cells{{"problem",
               "limit of grids",
               "known to",
               "difference",
               "violation",
               "CPU s",
               "blind starts solved",
               "at the least",
               "CPU s each"}};
  for (const LimitsRow& row : rows) {
    if (!row.direct) continue;
    const DirectAnswer& direct = *row.direct;
    const auto apart = difference(row);
    cells.push_back({row.problem.name,
                     direct.action ? text_number(*direct.action, 12) : "-",
                     direct.action ? text_number(direct.action_error, 2) : "-",
                     apart ? text_number(*apart, 2) : "-",
                     text_number(direct.violation, 2),
                     text_number(direct.seconds, 3),
                     fmt::format("{} of {}", direct.solved, direct.starts),
                     std::to_string(direct.least_found),
                     text_number(direct.seconds_per_start, 3)});
  }
  return cells;
}

std::string direct_title(const std::vector<LimitsRow>& rows) {
  const auto found =
      std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.direct; });
  return fmt::format(
      "{} on the midpoint grid, which keeps to the limits at its nodes: from carnot's path on "
      "three "
      "grids, and from blind starts",
      found->direct->solver);
}

Json direct_json(const LimitsRow& row) {
  if (!row.direct) return nullptr;
  const DirectAnswer& direct = *row.direct;
  return {{"solver", direct.solver},
          {"action", or_null(direct.action)},
          {"action_error", direct.action ? Json(direct.action_error) : Json(nullptr)},
          {"difference", or_null(difference(row))},
          {"violation", direct.violation},
          {"seconds", direct.seconds},
          {"starts", direct.starts},
          {"solved", direct.solved},
          {"least_found", direct.least_found},
          {"seconds_per_start", direct.seconds_per_start}};
}

}  // namespace

void add_limits_json(const std::vector<LimitsRow>& rows, Json& json) {
  Json list = Json::array();
  for (const LimitsRow& row : rows) {
    list.push_back({{"problem", row.problem.name},
                    {"scene", row.problem.scene},
                    {"from", row.problem.from},
                    {"to", row.problem.to},
                    {"limits", row.problem.asked.limits},
                    {"discs", row.problem.asked.discs},
                    {"action", row.own.solved ? Json(row.own.action) : Json(nullptr)},
                    {"verification", row.own.verification},
                    {"contacts", row.own.contacts},
                    {"violation", row.own.violation},
                    {"label", row.own.label},
                    {"seconds", row.own.seconds},
                    {"direct", direct_json(row)}});
  }
  json["rows"] = std::move(list);
}

std::string limits_text(const std::vector<LimitsRow>& rows) {
  std::string text = text_table(own_table(rows));
  if (has_direct(rows)) {
    text += fmt::format("\n{}\n\n{}", direct_title(rows), text_table(direct_table(rows)));
  }
  return text;
}

std::string limits_markdown(const std::vector<LimitsRow>& rows,
                            const std::vector<std::string>& arguments) {
  std::string text =
      fmt::format("{}\n## Limits\n\n{}", markdown_head(arguments), markdown_table(own_table(rows)));
  if (has_direct(rows)) {
    text += fmt::format("\n{}.\n\n{}", direct_title(rows), markdown_table(direct_table(rows)));
  }
  return text;
}

}  // namespace carnot::apps
