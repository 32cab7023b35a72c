// Configurations must lie on the holonomic constraints of their scene.
#pragma once

#include <string_view>

namespace carnot::apps {

// Throws std::invalid_argument where max |h(q)| is more than round-off of what a person types.
void check_holonomic(std::string_view option, std::string_view text, double residual);

}  // namespace carnot::apps
