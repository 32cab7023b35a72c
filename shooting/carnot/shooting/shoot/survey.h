// The measured flow along knots: action, length, errors, samples.
#pragma once

#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

// Runs every segment from its own knot; `steps` of the method in all, `samples` equidistant times
// of [0, T] recorded. Integrals are added up, errors are the largest, and the energy is compared
// with that of the first knot. On failure `report` says why.
FlowSummary survey(const BoundaryValueProblem& problem,
                   const Knots& knots,
                   long steps,
                   long samples);

// The samples alone, by as many steps or a few more, so that each ends a step. A sample within a
// step takes a step of its own, from the node before, and more iterations for it than the steps of
// a row.
Trajectory samples_of(const BoundaryValueProblem& problem,
                      const Knots& knots,
                      long steps,
                      long samples);

}  // namespace carnot::internal
