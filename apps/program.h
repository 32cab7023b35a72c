// The program without main(): parses, dispatches, turns refusals into one line and an exit status.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "run/deferred.h"
#include "run/subcommands.h"

namespace carnot::apps {

// What adds a subcommand (subcommands.h).
using AddSubcommand = void (*)(CLI::App& app, Invocation& invocation);

// A program of these subcommands, which lists those of other programs, too. `arguments` without the
// program's name. Never throws on bad input; returns the exit status.
int run_program(const std::vector<std::string>& arguments,
                std::span<const AddSubcommand> subcommands);

// What main() does: run_program, or become the program that has the subcommand where this one has
// not.
int run_main(int argc, char** argv, Program self, std::span<const AddSubcommand> subcommands);

}  // namespace carnot::apps
