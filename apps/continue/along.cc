#include "continue/along.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/plots/script.h"
#include "catalogue/scene_choice.h"
#include "run/search_options.h"
#include "text/numbers.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr std::string_view kLimit = "limit:";
constexpr std::string_view kDisc = "disc:";

std::string accepted_along(const SceneEntry& entry, const Ends& ends, const AskedLimits& asked) {
  std::string text = "to=Q1, from=Q0, time=T";
  for (const Limit& limit : ends.limits) text += fmt::format(", {}{}=BOUND", kLimit, limit.name);
  for (std::size_t k = 1; k <= asked.discs.size(); ++k)
    text += fmt::format(", {}{}=X,Y,R", kDisc, k);
  if (!entry.parameters.empty()) text += " or " + accepted_parameters(entry);
  return text;
}

// One number is the bound of a limit that has one, and where there are two opposite ones their
// size. A:B are both.
void parse_bounds(const std::string& option,
                  const std::string& value,
                  const Limit& limit,
                  Along& along) {
  const bool lower = std::isfinite(limit.lower);
  const bool upper = std::isfinite(limit.upper);
  const std::vector<std::string> parts = split(value, ':');
  if (parts.size() == 2 && lower && upper) {
    along.start = {limit.lower, limit.upper};
    along.end = {parse_real(option, parts[0]), parse_real(option, parts[1])};
    if (along.end[0] >= along.end[1]) refuse(option, value, "is empty", "A:B with A < B");
    return;
  }
  if (parts.size() != 1 || (lower && upper && limit.lower != -limit.upper)) {
    refuse(option, value, "does not say both bounds", lower && upper ? "A:B" : "a number");
  }
  along.start = {upper ? limit.upper : limit.lower};
  along.end = {lower && upper ? parse_positive(option, value) : parse_real(option, value)};
}

void move_bounds(const std::vector<double>& value, Limit& limit) {
  const bool lower = std::isfinite(limit.lower);
  const bool upper = std::isfinite(limit.upper);
  if (upper) limit.upper = value.back();
  if (lower) limit.lower = value.size() == 1 && upper ? -value.front() : value.front();
}

Along parse_limit(const std::string& name,
                  const std::string& text,
                  const std::string& value,
                  const Ends& ends,
                  const std::string& accepted) {
  Along along;
  along.kind = Along::Kind::kLimit;
  // A formula that is typed as a name may have other spaces.
  const auto plain = [](std::string typed) {
    std::erase(typed, ' ');
    return typed;
  };
  const std::string wanted = plain(name.substr(kLimit.size()));
  const auto found = std::find_if(ends.limits.begin(), ends.limits.end(), [&](const Limit& limit) {
    return plain(limit.name) == wanted;
  });
  if (found == ends.limits.end()) refuse("--along", text, "no such limit", accepted);
  along.index = found - ends.limits.begin();
  parse_bounds("--along " + name, value, *found, along);
  return along;
}

Along parse_moved_disc(const std::string& name,
                       const std::string& text,
                       const std::string& value,
                       const AskedLimits& asked,
                       const std::string& accepted) {
  Along along;
  along.kind = Along::Kind::kDisc;
  const std::string number = name.substr(kDisc.size());
  while (along.index < asked.discs.size() && std::to_string(along.index + 1) != number) {
    ++along.index;
  }
  if (along.index == asked.discs.size()) refuse("--along", text, "no such --disc", accepted);
  along.start = parse_disc("--disc", asked.discs[along.index]);
  along.end = parse_disc("--along " + name, value);
  return along;
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

Along parse_along(const std::string& text,
                  const Run& run,
                  const Ends& ends,
                  const AskedLimits& asked) {
  const std::string accepted = accepted_along(*run.entry, ends, asked);
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
  } else if (along.name.starts_with(kLimit)) {
    along = parse_limit(along.name, text, value, ends, accepted);
  } else if (along.name.starts_with(kDisc)) {
    along = parse_moved_disc(along.name, text, value, asked, accepted);
  } else {
    along.kind = Along::Kind::kParameter;
    along.end = {parse_parameter(*run.entry, "--along", text, accepted).second};
    along.start = {run.parameters.at(along.name)};
  }
  along.name = text.substr(0, equals);
  if (along.start == along.end) {
    refuse("--along", text, "is where it starts", "another value to end with");
  }
  return along;
}

ProblemLine line_of(const Along& along,
                    const Run& run,
                    const Ends& ends,
                    const AskedLimits& asked) {
  const BoundaryValueProblem problem = problem_between(run.dynamics, ends);
  switch (along.kind) {
    case Along::Kind::kTarget:
      return moving_target(problem, along.end);
    case Along::Kind::kStart:
      return moving_start(problem, along.end);
    case Along::Kind::kTime:
      return moving_time(problem, along.end.front());
    case Along::Kind::kLimit:
      return {[along, problem](double s) {
        BoundaryValueProblem changed = problem;
        move_bounds(along.value(s), changed.limits[along.index]);
        return changed;
      }};
    case Along::Kind::kDisc:
      return {[along, problem, &run, asked](double s) {
        AskedLimits moved = asked;
        moved.discs[along.index] = fmt::format("{:.17g}", fmt::join(along.value(s), ","));
        BoundaryValueProblem changed = problem;
        changed.limits = limits_of(moved, run);
        return changed;
      }};
    case Along::Kind::kParameter:
      break;
  }
  return {[along, problem, &run, asked](double s) {
    ParameterValues values = run.parameters;
    values[along.name] = along.value(s).front();
    BoundaryValueProblem changed = problem;
    changed.dynamics = run.make(values);
    changed.limits = changed.dynamics.info.limits;
    if (asked.any()) changed.limits = choose_limits(*run.entry, values, asked);
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
  if (along.kind == Along::Kind::kLimit && indices.size() == 1) {
    return plots::escaped("bound of " + along.name.substr(kLimit.size()));
  }
  if (along.kind == Along::Kind::kDisc && indices.size() == 1) {
    constexpr std::array kParts{"x", "y", "radius"};
    return plots::escaped(
        fmt::format("{} of disc {}", kParts[indices.front()], along.name.substr(kDisc.size())));
  }
  if (along.kind == Along::Kind::kLimit || along.kind == Along::Kind::kDisc) {
    return plots::escaped(fmt::format(
        "s, {} going from {} to {}", along.name, text_vector(along.start), text_vector(along.end)));
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
