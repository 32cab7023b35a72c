// The subcommands. Each is one source file that adds its options and what to do with them.
#pragma once

#include <string>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming): the name is that of CLI11
class App;
}

namespace carnot::apps {

// One call of the program.
struct Invocation {
  std::vector<std::string> arguments;  // as given, without the program's name
  int exit_status = 0;                 // set by the subcommand that ran
};

// What each does is in the file of its name. Their callbacks throw std::invalid_argument on bad
// input, before any work. `invocation` must outlive the parsing.
void add_geodesic(CLI::App& app, Invocation& invocation);
void add_atlas(CLI::App& app, Invocation& invocation);
void add_continue(CLI::App& app, Invocation& invocation);
void add_front(CLI::App& app, Invocation& invocation);
void add_flow(CLI::App& app, Invocation& invocation);
void add_scenes(CLI::App& app, Invocation& invocation);
void add_methods(CLI::App& app, Invocation& invocation);
void add_verify(CLI::App& app, Invocation& invocation);
void add_paper(CLI::App& app, Invocation& invocation);
void add_benchmark(CLI::App& app, Invocation& invocation);
void add_stress(CLI::App& app, Invocation& invocation);

}  // namespace carnot::apps
