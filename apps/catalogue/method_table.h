// The method that --method names, for one scene.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carnot/tableau/methods.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

// The names of the methods that can integrate the scene.
std::vector<std::string> method_names(const SceneEntry& entry);

// `name`, or where it is empty gauss16, or rattle where that is needed. Throws
// std::invalid_argument naming the methods that suit the scene.
const Method& choose_method(std::string_view name, const SceneEntry& entry);

}  // namespace carnot::apps
