// What a closed surface or curve of ends encloses, by the flux through it.
//
// `ends` has the coordinates of all vertices, one after the other: three of each for a surface, two
// for a curve. Images may be periods of angles apart, so the flux is that along a coordinate which
// is no angle.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/surface.h"

namespace carnot::internal {

// The volume inside the triangles of a surface in three coordinates.
double enclosed_volume(const Dynamics& dynamics,
                       const Surface& surface,
                       const std::vector<double>& ends);

// The area inside the segments of a curve in the plane. The inside is on the same side of all
// segments or, where momenta are two lines, on the other side of those of the second line.
double enclosed_area(const Dynamics& dynamics,
                     const Surface& surface,
                     const std::vector<double>& ends,
                     bool two_lines);

}  // namespace carnot::internal
