// The singular lines and points of a caustic on its mesh.
//
// At every vertex the cubic form C of the kernel is known (caustic_form.h). A kernel has two
// directions, and C is odd in them; so along an edge C is compared for directions of one side.
// Where it changes its sign the edge meets a cusp line, which is located there, and triangles tell
// which of these points follow each other. Close to an umbilic kernels turn within a triangle;
// lines end there, and may be broken (cusp_ends.h). Umbilics are looked for from each vertex at
// which E is nearer to zero than at its neighbours, and swallowtails where D changes its sign along
// a line.
#pragma once

#include <functional>
#include <vector>

#include "carnot/shooting/front/cusp_ends.h"
#include "carnot/shooting/front/surface.h"

namespace carnot::internal {

struct CausticLines {
  bool finished = false;  // false: stopped
  std::vector<CuspLine> cusps;
  std::vector<Umbilic> umbilics;
  std::vector<Swallowtail> swallowtails;
};

struct CausticRequest {
  const Dynamics& dynamics;
  const std::vector<double>& from;
  const UnitMomenta& momenta;
  const Surface& surface;
  const std::vector<double>& times;  // conjugate times of its vertices
  ConjugateTime conjugate_time;
  double length = 0;  // what is conjugate later is left out
  int threads = 0;
  std::function<bool()> go_on;
};

CausticLines caustic_lines(const CausticRequest& request);

}  // namespace carnot::internal
