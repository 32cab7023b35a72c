// Starts of the search for scenes without a midpoint transcription: random momenta at `from`.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// Start i: the momentum of the straight line first, then random ones of its size times 0.1 to 10,
// on the manifold where there are holonomic constraints. Empty where a draw has none.
std::vector<double> momentum_start(const BoundaryValueProblem& problem, std::uint64_t seed, int i);

}  // namespace carnot::internal
