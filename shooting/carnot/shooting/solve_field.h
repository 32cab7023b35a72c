// The least action from one start to every point of a grid of targets.
//
// A few searches give extremals, each neighbour is reached from the one beside it by Newton's
// method (field/field_sweep.h), mirror images take what their originals have, and what neighbours
// do not explain is searched again: with three coordinates some ten thousand points a second on
// each core, with four one or two thousand, where searches alone solve some ten.
#pragma once

#include <vector>

#include "carnot/shooting/field.h"

namespace carnot {

// `problem.to` gives the coordinates without an axis. For scenes with velocity constraints or
// driftless controls, and without a potential. Throws std::invalid_argument for other scenes, free
// ends, limits, no branches, a team without an exchange, and axes that are empty or not
// equidistant, and DamagedState. Memory: some 200 bytes a branch of a point with three coordinates,
// 300 with four, and the answer.
Field solve_field(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  const FieldOptions& options = {});

}  // namespace carnot
