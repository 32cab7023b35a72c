// The program of `carnot` with the laboratory, which `carnot` becomes for its subcommands.
#include <algorithm>
#include <array>

#include "program.h"
#include "text/interrupt.h"

int main(int argc, char** argv) {
  using namespace carnot::apps;
  guard_streams();
  watch_for_interrupts();
  constexpr std::array<AddSubcommand, 11> kSubcommands = {add_geodesic,
                                                          add_atlas,
                                                          add_continue,
                                                          add_front,
                                                          add_flow,
                                                          add_scenes,
                                                          add_methods,
                                                          add_verify,
                                                          add_paper,
                                                          add_benchmark,
                                                          add_stress};
  return run_program({argv + std::min(argc, 1), argv + argc}, kSubcommands);
}
