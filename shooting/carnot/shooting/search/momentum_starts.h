// Starts of the search for scenes without a midpoint transcription: random momenta at `from`, with
// the coordinate itself where the start is free (ends.h).
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

// Start 0 is the momentum of the straight line. The others are random, of its size times 0.1 to 10.
// Where holonomic constraints need forces they are brought to the manifold; the result is empty
// where that fails.
std::vector<double> momentum_start(const BoundaryValueProblem& problem, std::uint64_t seed, int i);

}  // namespace carnot::internal
