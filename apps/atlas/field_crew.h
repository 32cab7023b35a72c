// Fields that all ranks of a call solve together.
#pragma once

#include <vector>

#include "atlas/field_state.h"
#include "atlas/ranks.h"

namespace carnot::apps {

// FieldState::solve() with all ranks, each of which must call it; `options.progress` may stop them
// from any of them. What all of them refuse is thrown as there. Where one of them fails it says so,
// and all are ended.
Field solve_together(Ranks& ranks,
                     FieldState& state,
                     const BoundaryValueProblem& problem,
                     const std::vector<FieldAxis>& axes,
                     FieldOptions options);

}  // namespace carnot::apps
