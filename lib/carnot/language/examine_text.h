// What is found out about a scene from text at random points: its symmetries, and whether it is of
// index 1 at all.
#pragma once

#include <string>
#include <string_view>

#include "carnot/dynamics.h"
#include "carnot/language/describe_text.h"
#include "carnot/language/formulation.h"
#include "carnot/language/scene_source.h"

namespace carnot::language {

// The symmetries of H at random points: changes of signs, rigid motions of the plane, coordinates
// that H does not depend on. Up to 2^n evaluations of H at each point, a millisecond for n = 8.
Symmetries find_symmetries(const Dynamics& dynamics);

// Whether the mass is not positive definite at some random point where it was to be.
bool is_indefinite(const Dynamics& dynamics);

// Throws TextError where H_y = 0 cannot be solved at any of some random points, saying why, and for
// symmetries that the text claims and H does not have.
void check_text(const SceneSource& scene,
                const Formulation& formulation,
                const Dynamics& dynamics,
                std::string_view text,
                const std::string& file);

}  // namespace carnot::language
