// The sphere of a section (front/section_sphere.h) as the mesh that a user gets.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/front_mesh.h"

namespace carnot::internal {

// All but the seconds that it took. The options are those of check_wavefront(), and have a section.
// Cost: that of section_sphere(), and one conjugate time for each vertex.
FrontMesh make_section_mesh(const Dynamics& dynamics,
                            const std::vector<double>& from,
                            const FrontOptions& options);

}  // namespace carnot::internal
