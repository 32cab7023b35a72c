// The `carnot` program.
#include <algorithm>
#include <array>

#include "program.h"
#include "run/laboratory.h"
#include "text/interrupt.h"

int main(int argc, char** argv) {
  using namespace carnot::apps;
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  if (!arguments.empty() && is_laboratory_command(arguments.front())) {
    return become_laboratory(arguments);
  }
  guard_streams();
  watch_for_interrupts();
  constexpr std::array<AddSubcommand, 6> kSubcommands = {
      add_geodesic, add_atlas, add_continue, add_front, add_flow, add_scenes};
  return run_program(arguments, kSubcommands);
}
