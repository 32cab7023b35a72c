// What is large or small among the coordinates of a scene, whatever their units are.
#pragma once

#include <span>
#include <vector>

#include "carnot/scene/scene_info.h"

namespace carnot {

// Of each of the n coordinates or velocities x, the largest |x| among those with its unit. Numbers
// whose unit is radian or one are `least` at least: of coordinates 1 is large.
std::vector<double> sizes_by_unit(const SceneInfo& info, std::span<const double> x, double least);

}  // namespace carnot
