// Sewing the border of a sphere together along the cut locus.
//
// At a border vertex the cut time is the length of the sphere, and another momentum of the border,
// its partner, has the same image. So each vertex gets its partner as a vertex, too, where there is
// none, and both become one. Then edges of the border lie on edges: the surface is closed. The ends
// of curves are sewn to each other.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "carnot/shooting/front/surface.h"

namespace carnot::internal {

struct BorderVertex {
  int vertex = 0;
  bool at_conjugate = false;
  UnitMomentum partner;
};

// Adds partners to the surface, and gives the class of each vertex: the least vertex that it is one
// with. `make` fills the images of new vertices, number `first` and those after it, each the
// partner of a border vertex.
std::vector<int> sew(const std::vector<BorderVertex>& border,
                     const std::function<void(int first, const std::vector<int>& of)>& make,
                     Surface& surface);

// Edges inside the surface whose ends are one with those of another edge. Where the border folds
// onto itself, two of its vertices that are one may have a common neighbour.
std::vector<Edge> doubled_edges(const std::vector<int>& classes, const Surface& surface);

// V - E + F, and whether each edge is in two triangles, of a curve each vertex in two segments. All
// vertices count that a triangle has.
struct Topology {
  bool closed = false;
  int euler = 0;
};
Topology topology_of(const Surface& surface);

// Makes one of all vertices of a class; triangles and segments that lose an edge are left out.
void merge(const std::vector<int>& classes, Surface& surface);

}  // namespace carnot::internal
