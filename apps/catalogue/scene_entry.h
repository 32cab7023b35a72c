// Scenes without their types: what the subcommands know of a scene.
//
// An entry is data and one function that makes a Dynamics: make_entry.h turns a scene into one,
// listed_scenes() has them all.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
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

// A scene of the program before its entry is made. To read all scenes from text takes longer than
// most geodesics, so only those that are asked for are made (find_scene() in scene_choice.h).
struct ListedScene {
  std::string_view name;
  SceneEntry (*make)();
};

// All scenes of the program, in the order in which `carnot scenes` lists them.
const std::vector<ListedScene>& listed_scenes();

}  // namespace carnot::apps
