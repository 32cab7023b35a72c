// Eight trajectories side by side with the explicit method DOP853 and common, adaptive steps: the
// fastest way to many trajectories where symplecticity is not asked for.
//
// One step has 12 rates and two embedded results, of order 5 and 3, whose differences to that of
// order 8 make the error estimate; the lane with the largest one decides on the step.
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.10, and their code: coefficients of the
// embedded methods, error norm and step control, but with the largest component instead of the mean
// square, and without its stiffness detection and dense output.
#pragma once

#include "carnot/system/system_functions.h"

namespace carnot {

// Motions of a system over `duration`, with local errors of about `tolerance`, absolute below size
// 1 and relative above. Refers to the system and its functions.
struct AdaptiveFlow {
  const SystemFunctions& functions;
  const void* system;
  double start;
  double duration;
  double tolerance;
  long most_steps = 1L << 24;  // with the rejected ones; where they do not do the flow fails
};

struct AdaptiveReport {
  bool completed = false;
  long steps = 0;
  long rejected = 0;
  long evaluations = 0;  // per lane
  int hardest = 0;       // the lane that decided on the last step
};

// Advances kErasedLanes phase points, in rows of as many numbers. On failure z is where the last
// good step left it. `memory` is room for adaptive_rows() more rows.
AdaptiveReport dop853_adaptive(const AdaptiveFlow& flow, double* z, double* memory);
int adaptive_rows(const SystemFunctions& functions);

}  // namespace carnot
