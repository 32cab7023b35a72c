// Where a path on the grid meets walls, as a first guess of pieces (bound_arcs.h).
#pragma once

#include <optional>

#include "carnot/shooting/path/interior_point.h"
#include "carnot/shooting/shoot/bound_arcs.h"

namespace carnot::internal {

// What a contact of a path on the grid is taken for: an arc where the limit is of first order
// there, and a touch elsewhere; an arc; a touch where its multiplier is largest; or two touches,
// where the multiplier has its first and its last peak, with a flow between them that stays on the
// wall by itself. That is how limits of second order are kept to.
enum class Contacts { kByOrder, kArcs, kTouches, kPairs };

// The pieces of a path on the grid, by where its multipliers exceed its slacks. They consist of
// about so many segments over the whole time. Nothing where a wall is met at the start of the path
// or together with another one.
std::optional<BoundExtremal> pieces_of(const BoundaryValueProblem& problem,
                                       const Walls& walls,
                                       const InteriorPointOptions& options,
                                       const LimitedPath& limited,
                                       Contacts as,
                                       int segments);

}  // namespace carnot::internal
