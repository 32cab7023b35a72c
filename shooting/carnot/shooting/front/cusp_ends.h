// Cusp lines that end at umbilics.
//
// At a hyperbolic umbilic one cusp line goes over from a sheet of the caustic to the next one; at
// an elliptic umbilic three lines of each sheet end (Arnold, Gusein-Zade & Varchenko,
// Singularities of Differentiable Maps I, part III). Beside an umbilic kernels turn within a
// triangle of the mesh, so that lines that are found on it stop short, and pieces may be missing.
#pragma once

#include <vector>

#include "carnot/shooting/front/caustic_form.h"

namespace carnot::internal {

struct CausticPoint {
  UnitMomentum at;
  double t = 0;
};

struct CuspLine {
  std::vector<CausticPoint> points;
  bool closed = false;
  // The umbilics at its two ends, as places in a list; -1: none.
  int first_umbilic = -1;
  int last_umbilic = -1;
};

// Between two momenta, of c and w.
double distance_of(const UnitMomentum& a, const UnitMomentum& b);

// Leads the open lines of one sheet to the umbilics that they stop short of. A hyperbolic umbilic
// becomes the end of the longest line that stops near it, and pieces between the two become a part
// of that line; an elliptic umbilic becomes the end of the three nearest lines. Near is what is not
// much further away than points of the line are from each other.
void lead_to_umbilics(const std::vector<Umbilic>& umbilics, std::vector<CuspLine>& lines);

}  // namespace carnot::internal
