// The program without main(): parses, dispatches, turns refusals into one line and an exit status.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "run/subcommands.h"

namespace carnot::apps {

// What adds a subcommand (subcommands.h).
using AddSubcommand = void (*)(CLI::App& app, Invocation& invocation);

// A program of these subcommands, and of those of the laboratory where they are not among them.
// `arguments` without the program's name. Never throws on bad input; returns the exit status.
int run_program(const std::vector<std::string>& arguments,
                std::span<const AddSubcommand> subcommands);

}  // namespace carnot::apps
