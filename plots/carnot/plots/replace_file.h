// A finished file takes the place of another.
#pragma once

#include <string>

namespace carnot::plots {

// Moves the file `finished`, in the directory of what it replaces, to `path`: to where a symbolic
// link leads, and into what is no regular file, such as a pipe. Throws std::runtime_error; what was
// there before is then as it was.
void replace_file(const std::string& finished, const std::string& path);

// Where `path` leads through symbolic links, whether there is something or not.
std::string followed(const std::string& path);

}  // namespace carnot::plots
