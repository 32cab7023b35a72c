// Scenes with their types, for the generated file of each: all templates of the library behind one
// function. Everything else in the program includes scene_entry.h.
#pragma once

#include <string>

#include "carnot/make_dynamics.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

template <class Scene>
Scene with_parameters([[maybe_unused]] const ParameterValues& values) {
  Scene scene;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      const auto found = values.find(parameter.name);
      if (found != values.end()) scene.*parameter.value = found->second;
    }
  }
  return scene;
}

// make(scene, method): its Dynamics.
template <class Scene, class Make>
SceneEntry make_entry(const Make& make) {
  SceneEntry entry;
  Scene scene;
  entry.info = describe_scene(scene);
  entry.dof = Scene::kDof;
  entry.multipliers = decltype(make_system(scene))::kMultipliers;
  if constexpr (HasHolonomic<Scene>) entry.holonomic = Scene::kHolonomic;
  entry.needs_rattle = kNeedsRattle<Scene>;
  entry.suits = carnot::suits<Scene>;
  if constexpr (HasParameters<Scene>) {
    for (const auto& parameter : Scene::parameters()) {
      entry.parameters.push_back({parameter.name,
                                  scene.*parameter.value,
                                  parameter.unit,
                                  parameter.range,
                                  parameter.meaning});
    }
  }
  entry.make = [make](const ParameterValues& values, const std::string& method) {
    return make(with_parameters<Scene>(values), method);
  };
  return entry;
}

}  // namespace carnot::apps
