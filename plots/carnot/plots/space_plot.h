// A curve in space, in a box seen from above: time as colour, start and end marked, and either its
// shadow on the floor or the sphere it lies on.
#pragma once

#include <string>
#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/page.h"
#include "carnot/plots/panels.h"
#include "carnot/plots/space_view.h"

namespace carnot::plots {

// Points (x, y, z, t).
Rows space_rows(const SceneInfo& info, const Trajectory& trajectory);

std::vector<LegendEntry> space_legend(const SceneInfo& info);

// The box with walls, tics and labels, the path as far as row `last`, both ends, and the bodies at
// the given rows. The plot is in the units of the page.
void draw_space(Script& script,
                const Picture& page,
                const SceneInfo& info,
                const Trajectory& trajectory,
                const SpaceView& view,
                std::size_t last,
                const std::vector<std::size_t>& bodies);

// The whole page.
Picture space_picture(const SceneInfo& info, const std::vector<Curve>& curves);

}  // namespace carnot::plots
