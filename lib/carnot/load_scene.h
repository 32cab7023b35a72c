// Scenes from text: one's own system without a compiler (docs/scene_language.md).
//
//   const TextScene hooked = load_scene("hooked.scene").with({{"hook", 0.2}});
//   const Dynamics dynamics = make_dynamics(hooked);
//
// A scene from text has everything that a compiled one has: flows, tangents, geodesics, labels,
// pictures.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/scene/scene_info.h"

namespace carnot {

struct OwnMethod;

struct TextParameter {
  std::string name;
  double default_value = 0;
  double value = 0;
  std::string unit;
  Range range;
  std::string meaning;
};

// A scene that was read: its text, and what was made of it. Copies are cheap and share it.
class TextScene {
 public:
  // Names, units, periods, symmetries (those that were found), drawing and reports.
  [[nodiscard]] const SceneInfo& info() const;
  // In the order of the text, with the values that this scene has.
  [[nodiscard]] const std::vector<TextParameter>& parameters() const;
  // The number of coordinates, n.
  [[nodiscard]] int dof() const;
  // The number of multipliers, k.
  [[nodiscard]] int multipliers() const;
  // The number of holonomic constraints.
  [[nodiscard]] int holonomic() const;
  // What was read.
  [[nodiscard]] const std::string& text() const;
  // The same scene with other values of some parameters. Throws std::invalid_argument for one that
  // it does not have, and for values out of range. Costs as much as reading it.
  [[nodiscard]] TextScene with(const std::map<std::string, double>& values) const;

 private:
  friend TextScene scene_from_text(const std::string&, const std::string&, const std::string&);
  friend Dynamics make_dynamics(const TextScene&, std::string_view);
  friend Dynamics make_dynamics(const TextScene&, const OwnMethod&);
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

// Reads a scene. `name` is what it is called where the text does not say, `file` what errors call
// the text. Throws std::invalid_argument "FILE:LINE:COLUMN: what is wrong" with the line and a
// caret. About a millisecond.
TextScene scene_from_text(const std::string& text,
                          const std::string& name = "scene",
                          const std::string& file = "text");

// Reads a file; the scene is called like it. Throws std::invalid_argument where it can't be read.
TextScene load_scene(const std::string& path);

// As make_dynamics() of make_dynamics.h, with a method of carnot's by its name.
Dynamics make_dynamics(const TextScene& scene, std::string_view method = "gauss16");

// The same with a method of the user's own.
Dynamics make_dynamics(const TextScene& scene, const OwnMethod& own);

}  // namespace carnot
