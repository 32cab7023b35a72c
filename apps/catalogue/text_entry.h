// What the subcommands know of a scene from text.
#pragma once

#include <string_view>

#include "carnot/load_scene.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

SceneEntry text_entry(const TextScene& scene);

// Of a scene of the program that is compiled no other way: one of scene_texts().
SceneEntry program_text_entry(std::string_view name);

// Whether searches that ask for no method had better use the text of a scene of the program: where
// its class needs RATTLE. The text keeps holonomic constraints as Dh q' = 0 by any method; paths
// are the same, and there are grids and tangent flows.
bool is_searched_as_text(const SceneEntry& entry, std::string_view method);
// Its Dynamics by gauss16, with the drawing of the class.
Dynamics dynamics_of_text(const SceneEntry& entry, const ParameterValues& parameters);

}  // namespace carnot::apps
