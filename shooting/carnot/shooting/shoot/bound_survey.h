// The measured flow along pieces (bound_arcs.h): action, length, errors, samples, multipliers.
#pragma once

#include <vector>

#include "carnot/shooting/shoot/bound_arcs.h"

namespace carnot::internal {

// What flows of `steps` steps in all along the pieces say. Momenta of the trajectory are those of
// L - nu s. `defect` is the largest gap between two segments or at the target.
struct BoundSurvey {
  bool completed = false;
  FlowSummary summary;
  double defect = 0;
  std::vector<double> end;                 // z(T), without the momenta that a wall stops
  std::vector<double> largest_multiplier;  // nu, of each piece
  std::vector<double> least_multiplier;    // zero where it is nowhere negative; NaN: not known
  double stop = 0;                         // kappa, with which a wall stops the end
};
BoundSurvey survey_pieces(const BoundaryValueProblem& problem,
                          const Walls& walls,
                          const BoundExtremal& extremal,
                          long steps,
                          const std::vector<double>& times);

}  // namespace carnot::internal
