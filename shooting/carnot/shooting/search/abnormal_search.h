// The abnormal curve that a search for normal extremals does not see.
//
// A strictly abnormal curve may be the shortest of all (Liu & Sussmann, Memoirs of the AMS 564,
// 1995). No momentum leads along it, so no discrete extremal has a counterpart there: paths that
// are pulled tight come near to it, and Newton's method on the grid fails, with multipliers that
// grow without end. So it is looked for where no normal extremal was found, or where a path that
// was pulled tight is clearly shorter than all that were found.
#pragma once

#include <optional>

#include "carnot/shooting/extremal/verification.h"
#include "carnot/shooting/geodesic_options.h"

namespace carnot::internal {

class Search;

// The curve, where it is shorter than all that the search has found. It has the label kAbnormal, or
// is a verified extremal where a momentum leads along it after all.
std::optional<Extremal> abnormal_extremal(const BoundaryValueProblem& problem,
                                          const GeodesicOptions& options,
                                          const Search& search);

}  // namespace carnot::internal
