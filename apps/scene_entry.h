// Scenes without their types: what the subcommands know of a scene.
//
// make_entry<Scene>() turns a scene into data and one function that makes a Segment. It is
// instantiated in one source file per scene; scene_registry() lists them all.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "carnot/make_segment.h"

namespace carnot::apps {

struct ParameterInfo {
  std::string name;
  double default_value = 0;
  std::string unit;
  Range range;
  std::string meaning;
};

// Parameters by name; those left out keep their default.
using ParameterValues = std::map<std::string, double>;

struct SceneEntry {
  SceneInfo info;
  int dof = 0;
  int multipliers = 0;
  int holonomic = 0;
  std::vector<ParameterInfo> parameters;
  // Whether a method can integrate the scene.
  bool (*suits)(const Method&) = nullptr;
  // Throws std::invalid_argument on parameters out of range and methods that do not suit.
  std::function<Segment(const ParameterValues&, const std::string& method)> make;
};

// In the order of the house; made on first use.
const std::vector<SceneEntry>& scene_registry();

template <class Scene>
Scene with_parameters([[maybe_unused]] const ParameterValues& values) {
  Scene scene;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      const auto found = values.find(parameter.name);
      if (found != values.end()) parameter.value(scene) = found->second;
    }
  }
  return scene;
}

template <class Scene>
SceneEntry make_entry() {
  SceneEntry entry;
  Scene scene;
  entry.info = describe_scene(scene);
  entry.dof = Scene::kDof;
  entry.multipliers = decltype(make_system(scene))::kMultipliers;
  if constexpr (HasHolonomic<Scene>) entry.holonomic = Scene::kHolonomic;
  entry.suits = carnot::suits<Scene>;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      entry.parameters.push_back({parameter.name,
                                  parameter.value(scene),
                                  parameter.unit,
                                  parameter.range,
                                  parameter.meaning});
    }
  }
  entry.make = [](const ParameterValues& values, const std::string& method) {
    return make_segment(with_parameters<Scene>(values), method);
  };
  return entry;
}

}  // namespace carnot::apps
