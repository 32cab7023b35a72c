// carnot scenes: what can be computed, and with which parameters.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "catalogue/scene_choice.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kScenesFooter = R"(
Examples
  carnot scenes
  carnot scenes vehicle
  carnot scenes --json

Exit status: 0 success, 1 a file could not be written, 2 bad input, 130 interrupted.)";

struct ScenesCall {
  std::string scene;
  Destination destination;
};

Json scene_json(const SceneEntry& entry) {
  Json periods = Json::object();
  for (const Coordinate& coordinate : entry.info.configuration) {
    if (coordinate.period > 0) periods[coordinate.name] = coordinate.period;
  }
  Json parameters = Json::array();
  for (const ParameterInfo& parameter : entry.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"default", parameter.default_value},
                          {"unit", parameter.unit},
                          {"range", parameter.range.text()},
                          {"meaning", parameter.meaning}});
  }
  return {{"name", entry.info.name},
          {"summary", entry.info.summary},
          {"kind", entry.info.kind},
          {"configuration", coordinate_names(entry)},
          {"periods", std::move(periods)},
          {"multipliers", entry.multipliers},
          {"parameters", std::move(parameters)},
          {"reference", entry.info.reference}};
}

// One table, its lines under headings: the kinds, in the order of the registry.
std::string overview() {
  std::vector<const SceneEntry*> entries;
  std::vector<std::string> kinds;
  for (const SceneEntry& entry : scene_registry()) {
    entries.push_back(&entry);
    if (std::find(kinds.begin(), kinds.end(), entry.info.kind) == kinds.end()) {
      kinds.push_back(entry.info.kind);
    }
  }
  std::vector<std::vector<std::string>> rows;
  for (const SceneEntry* entry : entries) {
    rows.push_back({"  " + entry->info.name,
                    fmt::format("{}", fmt::join(coordinate_names(*entry), ", ")),
                    entry->info.summary});
  }
  std::istringstream table(text_table(rows));
  std::map<std::string, std::string> lines;
  std::string line;
  for (const SceneEntry* entry : entries) {
    std::getline(table, line);
    lines[entry->info.kind] += line + '\n';
  }
  std::string text;
  for (const std::string& kind : kinds) text += kind + '\n' + lines[kind];
  return text;
}

std::string details(const SceneEntry& entry) {
  const SceneInfo& info = entry.info;
  std::string text = fmt::format("{}: {}\n{}, {} multiplier{}\n",
                                 info.name,
                                 info.summary,
                                 info.kind,
                                 entry.multipliers,
                                 entry.multipliers == 1 ? "" : "s");
  if (!info.reference.empty()) text += info.reference + '\n';
  std::vector<std::vector<std::string>> coordinates{{"coordinate", "unit", "period"}};
  for (const Coordinate& c : info.configuration) {
    coordinates.push_back({c.name, c.unit, c.period > 0 ? text_number(c.period) : "-"});
  }
  text += '\n' + text_table(coordinates);
  if (entry.parameters.empty()) return text + "\nno parameters\n";
  std::vector<std::vector<std::string>> parameters{
      {"parameter", "default", "unit", "range", "meaning"}};
  for (const ParameterInfo& p : entry.parameters) {
    parameters.push_back({p.name, text_number(p.default_value), p.unit, p.range.text(), p.meaning});
  }
  return text + '\n' + text_table(parameters);
}

}  // namespace

void add_scenes(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<ScenesCall>();
  CLI::App& scenes = *app.add_subcommand("scenes", "List the scenes, or describe one.");
  scenes.add_option("SCENE", options->scene, "describe only this one")->type_name("");
  add_table_options(scenes, options->destination);
  scenes.footer(kScenesFooter);
  scenes.callback([options, &invocation] {
    const SceneEntry* one = options->scene.empty() ? nullptr : &find_scene(options->scene);
    check_table_output(options->destination);
    Json list = Json::array();
    if (one != nullptr) {
      list.push_back(scene_json(*one));
    } else {
      for (const SceneEntry& entry : scene_registry()) list.push_back(scene_json(entry));
    }
    Result result;
    result.json = result_head(invocation.arguments);
    result.json["scenes"] = std::move(list);
    result.text = [one] { return one == nullptr ? overview() : details(*one); };
    invocation.exit_status = deliver(result, options->destination);
  });
}

}  // namespace carnot::apps
