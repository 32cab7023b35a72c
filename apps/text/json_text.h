// JSON whose numbers read back exactly: 17 significant digits, null for what is not finite.
//
// Lists of plain values stand on one line, everything else is indented.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "carnot/flow/trajectory.h"

namespace carnot::apps {

using Json = nlohmann::ordered_json;

// The text, with a newline at the end.
std::string json_text(const Json& value);

// The same on one line, without a newline.
std::string json_line(const Json& value);

// {"t", "q", "p", "lambda", "hamiltonian"}.
Json trajectory_json(const Trajectory& trajectory);

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace carnot::apps
