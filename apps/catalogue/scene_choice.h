// The scene and its parameters as the command line names them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "catalogue/scene_entry.h"

namespace carnot::apps {

// Whether the name is that of a file with a scene.
bool is_scene_file(std::string_view name);

// A scene of the program, or of the file where the name ends in ".scene". Each is made once, and
// stays where it is. Throws std::invalid_argument naming the known scenes, or what is wrong in the
// file.
const SceneEntry& find_scene(std::string_view name);

// The names of the scenes of the program, in the order of `carnot scenes`.
std::vector<std::string> scene_names();

// Whether this is the entry of a scene of the program, and not of a file that gives one its name.
bool is_of_program(const SceneEntry& entry);

// One NAME=VALUE of a scene's parameter. Throws std::invalid_argument naming `option`, and what is
// accepted, on an unknown name, a value that is no number or out of range.
std::pair<std::string, double> parse_parameter(const SceneEntry& entry,
                                               std::string_view option,
                                               const std::string& text,
                                               const std::string& accepted);

// "NAME=VALUE with NAME one of ...".
std::string accepted_parameters(const SceneEntry& entry);

// All parameters of the scene: NAME=VALUE texts over the defaults. Throws std::invalid_argument on
// unknown names, values that are no numbers or out of range, and names set twice.
ParameterValues parse_parameters(const SceneEntry& entry, const std::vector<std::string>& texts);

// The names of the coordinates.
std::vector<std::string> coordinate_names(const SceneEntry& entry);

// {prefix1, prefix2, ...}.
std::vector<std::string> numbered_names(std::string_view prefix, int count);

}  // namespace carnot::apps
