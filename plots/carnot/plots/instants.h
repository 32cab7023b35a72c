// When to draw the body along a path, so that the motion can be read: at both ends, at the cusps,
// where it turns back, and at a few places between, evenly along the way and not by the clock.
#pragma once

#include <cstddef>
#include <vector>

#include "carnot/flow/reports.h"
#include "carnot/plots/script.h"
#include "carnot/scene/scene_info.h"

namespace carnot::plots {

// Rows where a line through these points, all of one length, turns back: the direction before and
// after differs by more than a right angle. One row for each cusp, neither the first nor the last.
// Points that are not finite and those that stay where they are have no direction.
std::vector<std::size_t> cusps(const Rows& points);

// At most `most` >= 2 rows of the trajectory in ascending order, the first and the last among them,
// and the cusps of the path, if there is room for all, but for those beside an end. The longer the
// way in sizes of the body, the more rows. Just the ends where the scene has no body, or nothing
// moves.
std::vector<std::size_t> body_instants(const SceneInfo& info,
                                       const Trajectory& trajectory,
                                       std::size_t most);

// The point of the path at a configuration: two numbers in the plane, three in space.
Row path_point(const SceneInfo& info, const std::vector<double>& q);
// Points of all the lines of the body there; none where it has no body or q is not finite.
Rows body_points(const SceneInfo& info, const std::vector<double>& q);

}  // namespace carnot::plots
