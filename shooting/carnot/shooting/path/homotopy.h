// A path that is carried along while the equations that it solves change.
#pragma once

#include <functional>

#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/stop.h"

namespace carnot::internal {

struct HomotopyOptions {
  double first_step = 0.01;
  int most_steps = 150;
  // After so many steps it is given up where not so much is done: it creeps.
  int patience = 20;
  double hardly = 0.015;
  Stop stop;
};

// Carries `path` from the solution for s = 0 to one for s = 1. correct(s, trial) makes a solution
// for s of a guess, and says whether it could. Guesses are on the line through the last two
// solutions; steps in s grow while that works and shrink where it does not. False where s = 1 is
// not reached; then the path is the last solution.
bool follow(const HomotopyOptions& options,
            const std::function<bool(double s, Path& trial)>& correct,
            Path& path);

}  // namespace carnot::internal
