// The `carnot` program: what a geodesic needs. It becomes another one for all else
// (run/deferred.h).
#include <array>

#include "program.h"

int main(int argc, char** argv) {
  using namespace carnot::apps;
  constexpr std::array<AddSubcommand, 3> kSubcommands = {add_geodesic, add_flow, add_scenes};
  return run_main(argc, argv, Program::kCarnot, kSubcommands);
}
