// A scene described as JSON.
#pragma once

#include "catalogue/scene_entry.h"
#include "text/json_text.h"

namespace carnot::apps {

// {"name", "summary", "kind", "configuration", "periods", "multipliers", "parameters",
// "reference"}.
Json scene_json(const SceneEntry& entry);

}  // namespace carnot::apps
