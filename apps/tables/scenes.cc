// carnot scenes: what can be computed, and with which parameters.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "catalogue/scene_choice.h"
#include "catalogue/scene_texts.h"
#include "run/delivery.h"
#include "run/subcommands.h"
#include "tables/scene_json.h"
#include "text/numbers.h"
#include "text/output_file.h"
#include "text/text_table.h"

namespace carnot::apps {
namespace {

constexpr const char* kScenesFooter = R"(
Examples
  carnot scenes
  carnot scenes vehicle
  carnot scenes --json
  carnot scenes vehicle --text              the scene in the language of docs/scene_language.md
  carnot scenes new robot                   writes robot.scene, a scene to begin with
  carnot scenes robot.scene

Exit status: 0 success, 1 a file could not be written, 2 bad input, 130 interrupted.)";

struct ScenesCall {
  std::string scene;
  std::string name;
  bool text = false;
  Destination destination;
};

// One table, its lines under headings: the kinds, in the order of the list of scenes.
std::string overview() {
  std::vector<const SceneEntry*> entries;
  std::vector<std::string> kinds;
  for (const std::string& name : scene_names()) {
    const SceneEntry& entry = find_scene(name);
    entries.push_back(&entry);
    if (std::find(kinds.begin(), kinds.end(), entry.info.kind) == kinds.end()) {
      kinds.push_back(entry.info.kind);
    }
  }
  std::vector<std::vector<std::string>> rows;
  rows.reserve(entries.size());
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

// Writes NAME.scene, which must not be there yet.
int write_new_scene(const std::string& name) {
  const std::string accepted = "a name of letters, digits, '-' and '_'";
  if (name.empty()) refuse_missing("NAME", accepted);
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_';
  });
  if (!plain || name[0] == '-') refuse("NAME", name, "not the name of a scene", accepted);
  const std::string path = name + ".scene";
  if (std::filesystem::exists(path)) {
    refuse("NAME", name, path + " is there already", "a name that is not taken");
  }
  try {
    write_file(path, new_scene_text(name));
  } catch (const std::runtime_error& error) {
    complain(error.what());
    return kNotDelivered;
  }
  fmt::print("written: {}\n", path);
  return kSuccess;
}

}  // namespace

void add_scenes(CLI::App& app, Invocation& invocation) {
  auto options = std::make_shared<ScenesCall>();
  CLI::App& scenes = *app.add_subcommand("scenes", "List the scenes, or describe one.");
  scenes.add_option("SCENE", options->scene, "describe only this one; or new")->type_name("");
  scenes.add_option("NAME", options->name, "what the new scene is called")->type_name("");
  scenes.add_flag("--text", options->text, "print the scene as text");
  add_table_options(scenes, options->destination);
  scenes.footer(kScenesFooter);
  scenes.callback([options, &invocation] {
    if (options->scene == "new") {
      invocation.exit_status = write_new_scene(options->name);
      return;
    }
    if (!options->name.empty()) {
      refuse("NAME", options->name, "only 'carnot scenes new NAME' takes one", "one scene");
    }
    if (options->text) {
      if (options->scene.empty()) refuse_missing("SCENE", "a scene for --text");
      fmt::print("{}", text_of_scene(find_scene(options->scene)));
      invocation.exit_status = kSuccess;
      return;
    }
    const SceneEntry* one = options->scene.empty() ? nullptr : &find_scene(options->scene);
    check_table_output(options->destination);
    Json list = Json::array();
    if (one != nullptr) {
      list.push_back(scene_json(*one));
    } else {
      for (const std::string& name : scene_names()) list.push_back(scene_json(find_scene(name)));
    }
    Result result;
    result.json = result_head(invocation.arguments);
    result.json["scenes"] = std::move(list);
    result.text = [one] { return one == nullptr ? overview() : details(*one); };
    invocation.exit_status = deliver(result, options->destination);
  });
}

}  // namespace carnot::apps
