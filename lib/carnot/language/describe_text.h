// What a scene from text says of itself.
#pragma once

#include "carnot/language/formulation.h"
#include "carnot/language/scene_source.h"

namespace carnot::language {

// Whether it is measured in radians or has a period.
bool is_angle(const Coordinate& coordinate);

// Names, units, drawing and reports. `formulation` is that of the scene.
SceneInfo describe_text(const SceneSource& scene, const Formulation& formulation);

// Adds the velocity constraint that keeps the value of limit `index`, or takes the control away
// that would change it. Throws std::invalid_argument where there is none.
void hold(SceneSource& scene, std::size_t index);

}  // namespace carnot::language
