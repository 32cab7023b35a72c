// Why a search has found nothing, and what to try.
#pragma once

#include <string>

#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/problem/natural_scales.h"
#include "carnot/shooting/reason.h"
#include "carnot/shooting/search/search.h"

namespace carnot::internal {

struct Failure {
  Reason reason = Reason::kNone;
  std::string message;
};

// The message says where the search came nearest. It gives the residual of the best path and, at
// its momentum, rank and condition of dq(T)/dp0, how far its end is from the target, the first
// conjugate time, and whether the saddle system is regular at the target. Lengths and times are put
// in the units that the scales are of.
Failure explain_failure(const BoundaryValueProblem& problem,
                        const NaturalScales& scales,
                        const Search& search,
                        const GeodesicOptions& options);

// The same where nothing but a strictly abnormal curve of this length was found, and none is
// wanted; and what there is to say where it is wanted and listed first.
Failure only_abnormal(double length);
std::string least_is_abnormal();

// What there is to say where starts ran into a singularity of the coordinates and others did not.
std::string blocked_starts(int blocked, int starts);

}  // namespace carnot::internal
