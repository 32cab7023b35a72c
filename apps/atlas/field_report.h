// What `carnot atlas` says of a field as a whole.
#pragma once

#include <string>

#include "carnot/shooting/solve_field.h"
#include "text/json_text.h"

namespace carnot::apps {

// Counts, and the figures that tell how far it can be trusted.
Json field_json(const Field& field);

// The same in words, some lines.
std::string field_text(const Field& field);

}  // namespace carnot::apps
