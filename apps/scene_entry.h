// Scenes without their types: what the subcommands know of a scene.
//
// make_entry<Scene>() turns a scene into data and one function that makes a Segment, for 1 to 8
// stages. It is instantiated in one source file per scene; scene_registry() lists them all.
#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "carnot/segment.h"

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
  std::vector<ParameterInfo> parameters;
  // A Segment with the Gauss method of 1 to 8 stages. Throws std::invalid_argument on parameters
  // out of range.
  std::function<Segment(const ParameterValues&, int stages)> make;
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
Segment make_segment(const Scene& scene, int stages) {
  switch (stages) {
    case 1:
      return make_gauss_segment<1>(scene);
    case 2:
      return make_gauss_segment<2>(scene);
    case 3:
      return make_gauss_segment<3>(scene);
    case 4:
      return make_gauss_segment<4>(scene);
    case 5:
      return make_gauss_segment<5>(scene);
    case 6:
      return make_gauss_segment<6>(scene);
    case 7:
      return make_gauss_segment<7>(scene);
    case 8:
      return make_gauss_segment<8>(scene);
    default:
      throw std::invalid_argument("stages " + std::to_string(stages) + " must be from 1 to 8");
  }
}

template <class Scene>
SceneEntry make_entry() {
  SceneEntry entry;
  Scene scene;
  entry.info = describe_scene(scene);
  entry.dof = Scene::kDof;
  entry.multipliers = Scene::kMultipliers;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      entry.parameters.push_back({parameter.name,
                                  parameter.value(scene),
                                  parameter.unit,
                                  parameter.range,
                                  parameter.meaning});
    }
  }
  entry.make = [](const ParameterValues& values, int stages) {
    return make_segment(with_parameters<Scene>(values), stages);
  };
  return entry;
}

}  // namespace carnot::apps
