// Many searches without a guess, on all threads, for the parts of a field that do not come from
// neighbours.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "carnot/shooting/find_geodesics.h"

namespace carnot::internal {

// The geodesic of least action that has a momentum, of each of `count` problems; `problem(k)` is
// called by many threads. A problem that is refused, such as one to a target with dependent
// constraints, has Reason::kIrregularEnd.
std::vector<GeodesicReport> cold_searches(
    std::size_t count,
    const std::function<BoundaryValueProblem(std::size_t)>& problem,
    GeodesicOptions search,
    int threads);

}  // namespace carnot::internal
