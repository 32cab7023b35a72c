// The mesh of a front, a sphere, a caustic or a cut locus, over a mesh of momenta of unit speed.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/front_mesh.h"

namespace carnot::internal {

// All but the seconds that it took. The options are those of check_wavefront().
FrontMesh make_front(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const FrontOptions& options);

}  // namespace carnot::internal
