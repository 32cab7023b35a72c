// Why a search has found nothing, and what to try.
#pragma once

#include <string>

#include "carnot/shooting/search.h"

namespace carnot {

// Where the search came nearest: the residual of the best path and, at its momentum, rank and
// condition of dq(T)/dp0, how far its end is from the target, the first conjugate time and whether
// the saddle system at the ends is regular.
std::string explain_failure(const BoundaryValueProblem& problem,
                            const Search& search,
                            const GeodesicOptions& options);

}  // namespace carnot
