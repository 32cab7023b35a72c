// Steps for a wanted error: of gauss16 by the Dynamics's own trial (automatic_flow.h), else
// doubling tells the error and the order tells the steps.
//
// With N and 2N steps of a method of order r the end points differ by e = |z_N - z_2N|, and since
// the error falls like N^-r, that of N is e / (1 - 2^-r). If it is not small enough, the next N is
// N (e / tolerance)^(1/r), and again 2N confirms it. Where e is not yet small N is doubled.
#pragma once

#include <string>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot {

enum class StepChoiceStatus { kOk, kNotReached, kStopped };

struct StepChoice {
  StepChoiceStatus status = StepChoiceStatus::kOk;
  long count = 0;        // equal steps
  double stop = 0;       // of the stage iteration, as in StepPlan
  double error = 0;      // estimated max-norm of the error of (q, p) at the end
  long evaluations = 0;  // rate() calls of the trial runs
  std::string message;   // why not reached
};

// `z` = (q, p) at `start`; it is not changed. With a `progress` the trials can be stopped.
StepChoice choose_steps(const Dynamics& dynamics,
                        double start,
                        double duration,
                        const std::vector<double>& z,
                        double tolerance,
                        const Progress& progress = {});

}  // namespace carnot
