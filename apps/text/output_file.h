// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace carnot::apps {

// Throws std::invalid_argument unless a file with one of these endings could be made at `path`.
void check_output_file(std::string_view option,
                       const std::string& path,
                       const std::vector<std::string>& endings);

[[nodiscard]] bool has_ending(const std::string& path, std::string_view ending);

// Writes under a temporary name in the same directory, then renames. Throws std::runtime_error and
// leaves nothing behind when that fails.
void write_file(const std::string& path, std::string_view text);

}  // namespace carnot::apps
