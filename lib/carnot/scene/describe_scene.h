// The description of a scene, completed where the scene leaves something out.
#pragma once

#include <string>

#include "carnot/scene/generalized_hamiltonian_scene.h"
#include "carnot/scene/lagrangian_scene.h"
#include "carnot/scene/optimal_control_scene.h"
#include "carnot/scene/scene_info.h"
#include "carnot/scene/velocity_constrained_scene.h"

namespace carnot {

// "Coin" for a struct Coin, in whatever namespace it is.
template <class Scene>
std::string type_name() {
  // "... [with Scene = A::Coin<2>; ...]" or "... [Scene = A::Coin<2>]"
  const std::string text = __PRETTY_FUNCTION__;
  const std::string head = "Scene = ";
  const std::size_t found = text.find(head);
  if (found == std::string::npos) return "scene";
  std::string name;
  int depth = 0;  // of brackets
  for (std::size_t i = found + head.size(); i < text.size(); ++i) {
    const char c = text[i];
    if (depth == 0 && (c == ';' || c == ']')) break;
    if (depth == 0 && c == ':') {
      name.clear();
      continue;
    }
    depth += c == '<' || c == '(' || c == '{' || c == '[' ? 1 : 0;
    depth -= c == '>' || c == ')' || c == '}' || c == ']' ? 1 : 0;
    name += c;
  }
  return name;
}

// The kind of a scene, by the formulas that it has.
template <class Scene>
const char* kind_of() {
  if constexpr (VelocityConstrainedScene<Scene>) {
    return HasHolonomic<Scene> ? "velocity + holonomic constraints" : "velocity constraints";
  } else if constexpr (LagrangianScene<Scene>) {
    return "Lagrangian";
  } else if constexpr (OptimalControlScene<Scene>) {
    return "optimal control";
  } else {
    static_assert(GeneralizedHamiltonianScene<Scene>, "a scene of no known kind");
    return "generalized Hamiltonian";
  }
}

// The scene's own description, and its kind. A scene without a name is called like its type,
// coordinates that are not described are called q1, ..., qn.
template <class Scene>
SceneInfo describe_scene(const Scene& scene) {
  SceneInfo info;
  if constexpr (HasInfo<Scene>) info = scene.info();
  if (info.name.empty()) info.name = type_name<Scene>();
  info.kind = kind_of<Scene>();
  if (info.configuration.empty()) {
    for (int i = 0; i < Scene::kDof; ++i) {
      // In one expression GCC 12 warns of a copy without end, where much is inlined (its bug
      // 105651).
      std::string name = "q";
      name += std::to_string(i + 1);
      info.configuration.push_back({name, "", 0});
    }
  }
  return info;
}

}  // namespace carnot
