// A path in the plane, with outlines of the body at a few well chosen instants, so that the
// manoeuvre can be read.
//
// Time is colour, from dark blue at the start to orange at the end; the bodies at both ends are
// heavy and opaque, those between are thin and let others through, and the path is drawn on top of
// these. Both axes have one scale. Several curves become panels with the same axes.
#pragma once

#include <vector>

#include "carnot/plots/curve.h"
#include "carnot/plots/panels.h"
#include "carnot/plots/plane.h"

namespace carnot::plots {

// Start, end, path, and the other wheels and the body if there is something to say of them.
std::vector<LegendEntry> path_legend(const SceneInfo& info,
                                     const Curve& curve,
                                     const PlaneFrame& frame);
// One panel: at most so many bodies, path, both ends.
void draw_path(Script& script,
               const SceneInfo& info,
               const Curve& curve,
               const PlaneFrame& frame,
               std::size_t bodies);

// The whole page.
Picture path_picture(const SceneInfo& info, const std::vector<Curve>& curves);

}  // namespace carnot::plots
