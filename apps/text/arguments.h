// The command line before CLI11 sees it.
//
// Values may begin with '-', as in `--from -pi/2,0,0,0`, which CLI11 takes for an option. So every
// `--name value` becomes `--name=value` first. Missing, empty and repeated values are refused here
// too, since CLI11 has its own ideas about them (`--from= x` would take x).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace carnot::apps {

// What a subcommand accepts, options with their leading dashes.
struct OptionNames {
  std::vector<std::string> valued;      // take one value, once
  std::vector<std::string> repeatable;  // take one value, any number of times
  std::vector<std::string> flags;       // take none
};

// Throws std::invalid_argument on a missing, empty, repeated or needless value.
std::vector<std::string> join_values(const std::vector<std::string>& arguments,
                                     const OptionNames& names);

// The text with control characters escaped, so that a message stays one line.
std::string one_line(std::string_view text);

}  // namespace carnot::apps
