#include "continue/along.h"

#include <fmt/format.h>

#include <algorithm>

#include "carnot/plots/script.h"
#include "catalogue/scene_choice.h"
#include "text/numbers.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

std::string accepted_along(const SceneEntry& entry) {
  std::string text = "to=Q1, from=Q0, time=T";
  if (!entry.parameters.empty()) text += " or " + accepted_parameters(entry);
  return text;
}

// The coordinates that change; all there is where one number does.
std::vector<std::size_t> changing(const Along& along) {
  std::vector<std::size_t> indices;
  for (std::size_t j = 0; j < along.start.size(); ++j) {
    if (along.start[j] != along.end[j]) indices.push_back(j);
  }
  return indices;
}

}  // namespace

std::vector<double> Along::value(double s) const {
  std::vector<double> value;
  for (std::size_t j = 0; j < start.size(); ++j) value.push_back((1 - s) * start[j] + s * end[j]);
  return value;
}

Along parse_along(const std::string& text, const Run& run, const Ends& ends) {
  const std::string accepted = accepted_along(*run.entry);
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse("--along", text, "there is no '='", accepted);
  Along along;
  along.name = text.substr(0, equals);
  const std::string value = text.substr(equals + 1);
  const std::string option = "--along " + along.name;
  if (along.name == "to" || along.name == "from") {
    along.kind = along.name == "to" ? Along::Kind::kTarget : Along::Kind::kStart;
    const bool target = along.kind == Along::Kind::kTarget;
    along.start = target ? ends.to : ends.from;
    along.end =
        parse_same_end(option, value, run, along.start, target ? ends.free_to : ends.free_from);
    if (run.dynamics.holonomic > 0) {
      refuse(option, value, "the way there leaves the holonomic constraints", "another --along");
    }
  } else if (along.name == "time") {
    along.kind = Along::Kind::kTime;
    along.start = {ends.time};
    along.end = {parse_positive(option, value)};
  } else {
    along.kind = Along::Kind::kParameter;
    along.end = {parse_parameter(*run.entry, "--along", text, accepted).second};
    along.start = {run.parameters.at(along.name)};
  }
  if (along.start == along.end) {
    refuse("--along", text, "is where it starts", "another value to end with");
  }
  return along;
}

ProblemLine line_of(const Along& along, const Run& run, const Ends& ends) {
  const BoundaryValueProblem problem = problem_between(run.dynamics, ends);
  switch (along.kind) {
    case Along::Kind::kTarget:
      return moving_target(problem, along.end);
    case Along::Kind::kStart:
      return moving_start(problem, along.end);
    case Along::Kind::kTime:
      return moving_time(problem, along.end.front());
    case Along::Kind::kParameter:
      break;
  }
  return {[along, problem, &run](double s) {
    ParameterValues values = run.parameters;
    values[along.name] = along.value(s).front();
    BoundaryValueProblem changed = problem;
    changed.dynamics = run.entry->make(values, run.method.name);
    return changed;
  }};
}

double axis_value(const Along& along, double s) {
  const std::vector<std::size_t> indices = changing(along);
  return indices.size() == 1 ? along.value(s)[indices.front()] : s;
}

std::string axis_label(const Along& along, const Run& run) {
  const std::vector<std::size_t> indices = changing(along);
  if (along.kind == Along::Kind::kTime) return "time T";
  if (along.kind == Along::Kind::kParameter) {
    const auto& parameters = run.entry->parameters;
    const auto found = std::find_if(
        parameters.begin(), parameters.end(), [&](const auto& p) { return p.name == along.name; });
    return plots::with_unit(plots::symbol(along.name), found->unit);
  }
  const char* end = along.kind == Along::Kind::kTarget ? "target" : "start";
  if (indices.size() == 1) {
    const Coordinate& coordinate = run.entry->info.configuration[indices.front()];
    return plots::with_unit(fmt::format("{} of the {}", plots::symbol(coordinate.name), end),
                            coordinate.unit);
  }
  return plots::escaped(fmt::format(
      "s, the {} going from {} to {}", end, text_vector(along.start), text_vector(along.end)));
}

}  // namespace carnot::apps
