// The box around a curve in space: its edges, and tics, numbers, labels and grid along three of
// them.
#pragma once

#include "carnot/plots/page.h"
#include "carnot/plots/space_view.h"

namespace carnot::plots {

// The edges of the floor and of the two walls behind; with a sphere, which needs no walls, the
// floor and the edge that carries the numbers of z.
Rows box_edges(const SpaceView& view);

// Writes numbers and labels outside of the box. Adds the lines of the tics, and those across the
// walls.
void label_box(Script& script,
               const Picture& page,
               const SceneInfo& info,
               const SpaceView& view,
               Rows& tics,
               Rows& grid);

}  // namespace carnot::plots
