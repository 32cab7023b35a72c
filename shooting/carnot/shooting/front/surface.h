// A piece of the momenta of unit speed, of triangles or a curve of segments, and where it goes.
//
// Every vertex is the place of a momentum, with an image in space. Edges whose images are too long,
// or at which the image is bent too sharply, get a vertex in their middle, and a triangle is cut in
// two, three or four by its edges that have one, a segment in two. So the mesh stays conforming,
// and since everything follows from the mesh before, it is the same for any number of threads.
#pragma once

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "carnot/shooting/front/columns.h"
#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

struct SurfaceVertex {
  UnitMomentum place;
  std::vector<double> image;  // NaN where there is none
};

// Parents of a new vertex, and its place between them.
struct Between {
  int a = 0;
  int b = 0;
  double part = 0.5;
};

// Two vertices, the lesser number first.
using Edge = std::pair<int, int>;
inline Edge edge_of(int a, int b) { return a < b ? Edge{a, b} : Edge{b, a}; }

struct Surface {
  std::vector<SurfaceVertex> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> segments;  // instead of triangles

  // A point on the edge, without an image.
  [[nodiscard]] SurfaceVertex between(const Between& part) const;
  // Which vertices share a triangle or a segment with each.
  [[nodiscard]] std::vector<std::vector<int>> neighbours() const;
  // Whether each vertex is on an edge of one triangle only, or the end of one segment only.
  [[nodiscard]] std::vector<bool> on_border() const;
  [[nodiscard]] bool empty() const { return triangles.empty() && segments.empty(); }
};

// All momenta of unit speed, or those of the columns where there is a line. On a circle times a
// line number k of the columns has the vertices k, k + (number of columns) and so on.
Surface first_surface(const UnitMomenta& momenta, const std::vector<Column>& columns);

// Fills the images of new vertices, number `first` and those after it, whose parents are given;
// false to stop.
using MakeVertices = std::function<bool(int first, const std::vector<Between>& parents)>;

// What refines a surface.
struct SurfaceRefinement {
  double longest = 0;   // edge, in the units of images
  double sharpest = 0;  // angle between neighbours, in radians
  double shortest = 0;  // edges are not cut for an angle below this
  int most = 0;         // vertices
  MakeVertices make;
};

// How many edges still ask to be cut when `most` is reached; -1 where it was stopped.
long refine(const SurfaceRefinement& how, Surface& surface);

// Gives each of these edges, which differ, a vertex in its middle. False when stopped.
bool cut_edges(const std::vector<Edge>& cut, const MakeVertices& make, Surface& surface);

// Cuts the surface where `inside` changes and keeps what is inside. `locate` gives the place of the
// border on the edges that cross it, from an inner vertex to an outer one, and `make` makes these
// vertices.
void clip(const std::vector<bool>& inside,
          const std::function<void(std::vector<Between>&)>& locate,
          const MakeVertices& make,
          Surface& surface);

// Leaves out vertices that no triangle has. `kept` gets the old number of each.
void drop_unused(Surface& surface, std::vector<int>& kept);

}  // namespace carnot::internal
