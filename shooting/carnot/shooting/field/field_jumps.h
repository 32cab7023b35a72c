// Points of a field that are much farther than a neighbour.
//
// The distance of two neighbours differs by no more than the path between them is long. What that
// is would have to be searched; most pairs along an axis differ by as much as is usual there, and
// a pair that differs by several times as much is worth a search. Beside points that only a
// singular extremal reaches, neighbours promise nothing that Newton's method could keep, and a
// random sample hardly meets them: they are few.
#pragma once

#include <span>
#include <vector>

#include "carnot/shooting/field/field_grid.h"

namespace carnot::internal {

// The farther points of such pairs, ascending, without those whose distance is not finite.
// `distances` are of all points. Cost: some passes over them.
std::vector<long> points_beyond_jumps(const FieldGrid& grid, std::span<const double> distances);

}  // namespace carnot::internal
