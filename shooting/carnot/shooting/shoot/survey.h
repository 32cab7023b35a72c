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

}  // namespace carnot::internal
