// The program without main(): parses, dispatches, turns refusals into one line and an exit status.
#pragma once

#include <string>
#include <vector>

namespace carnot::apps {

// `arguments` without the program's name. Never throws on bad input; returns the exit status.
int run_program(const std::vector<std::string>& arguments);

}  // namespace carnot::apps
