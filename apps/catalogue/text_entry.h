// What the subcommands know of a scene from text.
#pragma once

#include <string_view>

#include "carnot/load_scene.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

SceneEntry text_entry(const TextScene& scene);

// Of a scene of the program that is compiled no other way: one of scene_texts().
SceneEntry program_text_entry(std::string_view name);

}  // namespace carnot::apps
