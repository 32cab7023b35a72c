// How a set of places of a grid hangs together.
//
// Cubes are cut in six tetrahedra around a diagonal (Kuhn): corners of a simplex are a chain of
// places, each one step or more along axes that the chain has not gone along yet. The simplices
// whose corners all belong to the set make a body, and V - E + F - T is its Euler characteristic:
// that of pieces, less one for each handle, and one more for each hollow.
#pragma once

#include <functional>

#include "carnot/shooting/field/field_grid.h"

namespace carnot::internal {

struct GridTopology {
  int pieces = 0;
  int euler = 0;
  // Handles less hollows.
  [[nodiscard]] int handles() const { return pieces - euler; }
};

// Of a grid with up to three axes that end.
GridTopology grid_topology(const FieldGrid& grid, const std::function<bool(long)>& belongs);

}  // namespace carnot::internal
