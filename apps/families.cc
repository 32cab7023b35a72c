// The program of `carnot` with what makes families of geodesics, which `carnot` becomes for them.
#include <array>

#include "program.h"

int main(int argc, char** argv) {
  using namespace carnot::apps;
  constexpr std::array<AddSubcommand, 6> kSubcommands = {
      add_geodesic, add_flow, add_scenes, add_atlas, add_continue, add_front};
  return run_main(argc, argv, Program::kFamilies, kSubcommands);
}
