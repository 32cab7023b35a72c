// Fronts, spheres, caustics and cut loci of a point, as surfaces of triangles or, in the plane, as
// curves.
//
// The extremals of unit speed from a point are told by their momenta, a circle times a line where
// two directions are admissible, a sphere where three are (front/unit_momenta.h). Of these a mesh
// shows
//
//   the front    where all of them are at the time R,
//   the sphere   those that are still shortest paths there: up to their cut time R; its border is
//                sewn together along the cut locus, so that it is closed,
//   the caustic  their first conjugate points, or those of an order k, at times up to R,
//   the cut      where they stop being the shortest, at times up to R.
//
// A line is infinite. Far along its line extremals turn ever faster, and are conjugate ever
// earlier. So a sphere needs but a part of it, and of the others the mesh leaves the rest out, and
// says so. The mesh is refined (front/surface.h) until edges and angles are as asked for.
//
// For scenes with two or three admissible directions, and any with two coordinates. With two or
// three coordinates the mesh is the whole; with more it is a section: momenta are fixed until a
// surface is left, or a condition on the ends of a front or a sphere leaves one.
#pragma once

#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/front_mesh.h"

namespace carnot {

// At `from`, of length n. Throws std::invalid_argument on bad input.
FrontMesh wavefront(const Dynamics& dynamics,
                    const std::vector<double>& from,
                    const FrontOptions& options);

// Throws what wavefront() would throw.
void check_wavefront(const Dynamics& dynamics,
                     const std::vector<double>& from,
                     const FrontOptions& options);

}  // namespace carnot
