// The sphere of a section by a condition on the ends (front/end_condition.h): the places of the
// section at a distance R, where three coordinates are left.
//
// It is the level set of the distance, from a field on a grid of the section (field/). Cubes of the
// grid are cut in six tetrahedra each, around a diagonal (Kuhn), and of each edge between a nearer
// and a farther place the point at the distance R is a vertex (front/level_point.h). Extremals at
// the ends of the edge lead to it, and those of the vertices nearby: of all that arrive on the edge
// the one farthest out is on the sphere, for the distance is the least of all lengths. Where
// neighbours have different extremals the cut locus lies between them, and a face that it crosses
// gets the vertex at which both are as short. So the mesh is closed by construction, and its seam
// is a line of vertices.
#pragma once

#include <array>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/front/section_field.h"

namespace carnot::internal {

struct SphereVertex {
  std::vector<double> q;
  std::vector<double> p0;     // of unit speed
  std::vector<double> other;  // of another extremal that arrives in the same time; mostly empty
};

struct SectionSphere {
  bool finished = false;  // false: stopped
  std::vector<SphereVertex> vertices;
  std::vector<std::array<int, 3>> triangles;
  double volume = 0;  // inside, in the three coordinates
  long searches = 0;
  long unknown = 0;  // places of the grid whose distance is not known
  long rough = 0;    // vertices that no extremal led to, between the places of an edge
};

// For four coordinates. Cost: a field of (1.73 / edge)^3 places, and some 30 tangent flows a
// vertex.
SectionSphere section_sphere(const Dynamics& dynamics,
                             const std::vector<double>& from,
                             const SectionOptions& options);

}  // namespace carnot::internal
