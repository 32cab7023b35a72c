// The first conjugate time of a ray, fast: where det dq(t)/dp(0) first changes its sign.
//
// An even multiplicity would go unseen; conjugate_times.h sees it, at some fifty times the cost.
#pragma once

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

// Infinite where there is none up to `horizon`, NaN where the flow fails.
double first_conjugate_time(const Ray& ray, double horizon);

}  // namespace carnot::internal
