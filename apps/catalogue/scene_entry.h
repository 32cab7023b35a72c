// Scenes without their types: what the subcommands know of a scene.
//
// An entry is data and one function that makes a Dynamics: make_entry.h turns a scene into one,
// scene_registry() lists them all.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot {
struct Method;
}

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
  std::string text;           // of a scene that was read from text; empty: it is one of the program
  bool needs_rattle = false;  // the holonomic constraints do
  std::vector<ParameterInfo> parameters;
  // Whether a method can integrate the scene.
  std::function<bool(const Method&)> suits;
  // Throws std::invalid_argument on parameters out of range and methods that do not suit.
  std::function<Dynamics(const ParameterValues&, const std::string& method)> make;
};

// All scenes, in the order in which `carnot scenes` lists them; made on first use.
const std::vector<SceneEntry>& scene_registry();

}  // namespace carnot::apps
