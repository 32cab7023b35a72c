// The scenes of the program in the language of docs/scene_language.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalogue/scene_entry.h"

namespace carnot::apps {

struct SceneText {
  std::string_view name;
  std::string_view text;
};

// Those of lib/carnot/scenes/*.scene, which are part of the program.
const std::vector<SceneText>& scene_texts();

// Those of docs/examples/scenes that `carnot benchmark --drift` solves.
const std::vector<SceneText>& drift_texts();

// The text of a scene. Throws std::invalid_argument where there is none.
std::string text_of_scene(const SceneEntry& entry);

// A scene to begin with, with comments.
std::string new_scene_text(const std::string& name);

}  // namespace carnot::apps
