// What a scene from text says of itself.
#pragma once

#include "carnot/language/formulation.h"
#include "carnot/language/scene_source.h"

namespace carnot::language {

// Whether it is measured in radians or has a period.
bool is_angle(const Coordinate& coordinate);

// Names, units, drawing and reports. `formulation` is that of the scene.
SceneInfo describe_text(const SceneSource& scene, const Formulation& formulation);

}  // namespace carnot::language
