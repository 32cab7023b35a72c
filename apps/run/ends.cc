#include "run/ends.h"

#include <algorithm>

#include "catalogue/holonomic_check.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

bool any(const std::vector<bool>& free) {
  return std::find(free.begin(), free.end(), true) != free.end();
}

std::vector<bool> free_of(const std::vector<std::optional<double>>& typed) {
  std::vector<bool> free;
  free.reserve(typed.size());
  for (const auto& value : typed) free.push_back(!value);
  return free;
}

std::vector<double> filled(const std::vector<std::optional<double>>& typed,
                           const std::vector<std::optional<double>>& other) {
  std::vector<double> values;
  values.reserve(typed.size());
  for (std::size_t j = 0; j < typed.size(); ++j) {
    values.push_back(typed[j].value_or(other[j].value_or(0)));
  }
  return values;
}

void check_typed(std::string_view option,
                 const std::string& text,
                 const Dynamics& dynamics,
                 const std::vector<double>& end,
                 const std::vector<bool>& free) {
  if (any(free) && dynamics.holonomic > 0) {
    refuse(option,
           text,
           "a coordinate that h(q) = 0 ties to the others cannot be free",
           "a number for each coordinate");
  }
  check_end(option, text, dynamics, end);
}

}  // namespace

Ends ends_of(const std::vector<std::optional<double>>& from,
             const std::vector<std::optional<double>>& to) {
  Ends ends;
  ends.from = filled(from, to);
  ends.to = filled(to, from);
  ends.free_from = free_of(from);
  ends.free_to = free_of(to);
  return ends;
}

Ends parse_ends(const std::string& from,
                const std::string& to,
                const std::string& time,
                const Run& run) {
  const auto names = coordinate_names(*run.entry);
  if (from.empty()) refuse_missing("--from", end_accepted(names));
  if (to.empty()) refuse_missing("--to", end_accepted(names));
  const auto start = parse_end("--from", from, names);
  const auto target = parse_end("--to", to, names);
  Ends ends = ends_of(start, target);
  check_typed("--from", from, run.dynamics, ends.from, ends.free_from);
  check_typed("--to", to, run.dynamics, ends.to, ends.free_to);
  ends.time = parse_positive("--time", time);
  return ends;
}

std::vector<double> parse_same_end(std::string_view option,
                                   const std::string& text,
                                   const Run& run,
                                   const std::vector<double>& end,
                                   const std::vector<bool>& free) {
  const auto typed = parse_end(option, text, coordinate_names(*run.entry));
  if (free_of(typed) != free) {
    refuse(option, text, "other coordinates are free than at the start", end_text(end, free));
  }
  std::vector<double> values = end;
  for (std::size_t j = 0; j < end.size(); ++j) values[j] = typed[j].value_or(end[j]);
  check_typed(option, text, run.dynamics, values, free);
  return values;
}

void check_ends(const Ends& ends, const Dynamics& dynamics) {
  check_typed("from", end_text(ends.from, ends.free_from), dynamics, ends.from, ends.free_from);
  check_typed("to", end_text(ends.to, ends.free_to), dynamics, ends.to, ends.free_to);
}

bool has_free(const Ends& ends) { return any(ends.free_from) || any(ends.free_to); }

BoundaryValueProblem problem_between(const Dynamics& dynamics, const Ends& ends) {
  BoundaryValueProblem problem(dynamics, ends.from, ends.to, ends.time);
  problem.free_from = ends.free_from;
  problem.free_to = ends.free_to;
  problem.limits = ends.limits;
  return problem;
}

Json end_json(const std::vector<double>& end, const std::vector<bool>& free) {
  Json json = Json::array();
  for (std::size_t j = 0; j < end.size(); ++j) {
    json.push_back(free[j] ? Json(nullptr) : Json(end[j]));
  }
  return json;
}

std::string end_text(const std::vector<double>& end, const std::vector<bool>& free) {
  std::string text = "(";
  for (std::size_t j = 0; j < end.size(); ++j) {
    text += j > 0 ? ", " : "";
    text += free[j] ? "*" : text_number(end[j]);
  }
  return text + ")";
}

}  // namespace carnot::apps
