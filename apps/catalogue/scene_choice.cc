#include "catalogue/scene_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <set>

#include "carnot/language/nearest.h"
#include "carnot/load_scene.h"
#include "catalogue/text_entry.h"
#include "text/numbers.h"

namespace carnot::apps {
namespace {

std::vector<std::string> parameter_names(const SceneEntry& entry) {
  std::vector<std::string> names;
  for (const ParameterInfo& parameter : entry.parameters) names.push_back(parameter.name);
  return names;
}

}  // namespace

bool is_scene_file(std::string_view name) {
  constexpr std::string_view kEnding = ".scene";
  return name.size() > kEnding.size() && name.substr(name.size() - kEnding.size()) == kEnding;
}

const SceneEntry& find_scene(std::string_view name) {
  static std::mutex guard;
  static std::map<std::string, SceneEntry, std::less<>> made;
  const std::lock_guard lock(guard);
  if (const auto known = made.find(name); known != made.end()) return known->second;
  if (is_scene_file(name)) {
    return made.emplace(name, text_entry(load_scene(std::string(name)))).first->second;
  }
  for (const ListedScene& scene : listed_scenes()) {
    if (scene.name == name) return made.emplace(name, scene.make()).first->second;
  }
  const std::vector<std::string> names = scene_names();
  const std::string accepted = fmt::format("{}", fmt::join(names, ", "));
  if (name.empty()) refuse("SCENE", name, "no scene is given", accepted);
  refuse("SCENE", name, "no such scene" + language::suggestion(name, names), accepted);
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const ListedScene& scene : listed_scenes()) names.emplace_back(scene.name);
  return names;
}

bool is_of_program(const SceneEntry& entry) {
  return std::any_of(listed_scenes().begin(), listed_scenes().end(), [&](const ListedScene& scene) {
    return scene.name == entry.info.name && &find_scene(scene.name) == &entry;
  });
}

std::string accepted_parameters(const SceneEntry& entry) {
  if (entry.parameters.empty()) return "none: " + entry.info.name + " has no parameters";
  return fmt::format("NAME=VALUE with NAME one of {}", fmt::join(parameter_names(entry), ", "));
}

std::pair<std::string, double> parse_parameter(const SceneEntry& entry,
                                               std::string_view option,
                                               const std::string& text,
                                               const std::string& accepted) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) refuse(option, text, "there is no '='", accepted);
  const std::string name = text.substr(0, equals);
  const auto found = std::find_if(entry.parameters.begin(),
                                  entry.parameters.end(),
                                  [&](const ParameterInfo& p) { return p.name == name; });
  if (found == entry.parameters.end()) {
    const std::string why = fmt::format("{} has no parameter '{}'{}",
                                        entry.info.name,
                                        name,
                                        language::suggestion(name, parameter_names(entry)));
    refuse(option, text, why, accepted);
  }
  const double value = parse_real(fmt::format("{} {}", option, name), text.substr(equals + 1));
  if (!found->range.contains(value)) {
    refuse(option, text, "out of range", fmt::format("{} {}", name, found->range.text()));
  }
  return {name, value};
}

ParameterValues parse_parameters(const SceneEntry& entry, const std::vector<std::string>& texts) {
  ParameterValues values;
  for (const ParameterInfo& parameter : entry.parameters) {
    values[parameter.name] = parameter.default_value;
  }
  std::set<std::string> seen;
  for (const std::string& text : texts) {
    const auto [name, value] = parse_parameter(entry, "--set", text, accepted_parameters(entry));
    if (!seen.insert(name).second) {
      refuse("--set", text, name + " is set twice", "each parameter once");
    }
    values[name] = value;
  }
  return values;
}

std::vector<std::string> coordinate_names(const SceneEntry& entry) {
  std::vector<std::string> names;
  for (const Coordinate& coordinate : entry.info.configuration) names.push_back(coordinate.name);
  return names;
}

std::vector<std::string> numbered_names(std::string_view prefix, int count) {
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) names.push_back(fmt::format("{}{}", prefix, i));
  return names;
}

}  // namespace carnot::apps
