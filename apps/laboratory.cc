// The program of `carnot` with the laboratory, which `carnot` becomes for its subcommands.
#include <array>

#include "program.h"

int main(int argc, char** argv) {
  using namespace carnot::apps;
  constexpr std::array<AddSubcommand, 11> kSubcommands = {add_geodesic,
                                                          add_flow,
                                                          add_scenes,
                                                          add_atlas,
                                                          add_continue,
                                                          add_front,
                                                          add_methods,
                                                          add_verify,
                                                          add_paper,
                                                          add_benchmark,
                                                          add_stress};
  return run_main(argc, argv, Program::kLaboratory, kSubcommands);
}
