// The `carnot` program.
#include <algorithm>

#include "program.h"
#include "text/interrupt.h"

int main(int argc, char** argv) {
  carnot::apps::watch_for_interrupts();
  return carnot::apps::run_program({argv + std::min(argc, 1), argv + argc});
}
