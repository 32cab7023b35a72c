#include "catalogue/text_entry.h"

#include <algorithm>
#include <cassert>
#include <string>

#include "carnot/tableau/methods.h"
#include "catalogue/scene_texts.h"

namespace carnot::apps {

SceneEntry text_entry(const TextScene& scene) {
  SceneEntry entry;
  entry.info = scene.info();
  entry.text = scene.text();
  entry.dof = scene.dof();
  entry.multipliers = scene.multipliers();
  for (const TextParameter& p : scene.parameters()) {
    entry.parameters.push_back({p.name, p.default_value, p.unit, p.range, p.meaning});
  }
  entry.holonomic = scene.holonomic();
  entry.suits = [held = scene.holonomic() > 0](const Method& method) {
    return !held || method.family != kRattleFamily;
  };
  entry.make = [scene](const ParameterValues& values, const std::string& method) {
    const bool same = std::all_of(
        scene.parameters().begin(), scene.parameters().end(), [&](const TextParameter& p) {
          const auto value = values.find(p.name);
          return value == values.end() || value->second == p.value;
        });
    return make_dynamics(same ? scene : scene.with(values), method);
  };
  return entry;
}

SceneEntry program_text_entry(std::string_view name) {
  const auto& texts = scene_texts();
  const auto found = std::find_if(
      texts.begin(), texts.end(), [&](const SceneText& known) { return known.name == name; });
  assert(found != texts.end());
  return text_entry(
      scene_from_text(std::string(found->text), std::string(name), std::string(name)));
}

bool is_searched_as_text(const SceneEntry& entry, std::string_view method) {
  return entry.needs_rattle && method.empty();
}

Dynamics dynamics_of_text(const SceneEntry& entry, const ParameterValues& parameters) {
  Dynamics dynamics = program_text_entry(entry.info.name).make(parameters, "gauss16");
  dynamics.info = entry.make(parameters, "rattle").info;
  return dynamics;
}

}  // namespace carnot::apps
