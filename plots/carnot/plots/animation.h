// A manoeuvre as a film: start and end ghosted, the body moving, the path drawn as it is
// travelled. In space the view turns slowly.
#pragma once

#include "carnot/plots/curve.h"
#include "carnot/plots/plot_file.h"

namespace carnot::plots {

Picture plane_animation(const SceneInfo& info, const Curve& curve);
Picture space_animation(const SceneInfo& info, const Curve& curve);

}  // namespace carnot::plots
