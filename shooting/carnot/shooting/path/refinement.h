// From a discrete extremal on a coarse grid to knots that shooting can start from.
//
// The midpoint transcription has an error h^2 (e_2(t) + h^2 e_4(t) + ...). So the number of
// intervals is doubled until the momenta change by little, each time with Newton's method
// (discrete_newton.h). Of the last two grids the combination (4 fine - coarse)/3 has an error of
// order h^4 (Richardson). Boundary layers, such as that of a short steering axle on a long way,
// need many intervals; most problems do not. A coarse extremal that has no fine counterpart is an
// artefact of the grid and ends here.
//
// A path of a heavier problem goes down its ladder on the way (mass_ladder.h). What its grids
// differ by says something once both are of the problem itself.
//
// On a long way with drift a coarse grid is late by a part of a revolution. Where Newton's method
// does not find the fine counterpart at once, it follows it while what its equations leave at the
// start is taken back (homotopy.h). Layers that light coordinates make ask for the same.
//
// A grid is evaluated eight intervals side by side. Several paths side by side (newton_lanes.h) are
// not sooner done: there are three to five at once. With three or more in lanes sideways parking
// took as long, and searches to random targets of trailer2 no less.
#pragma once

#include <vector>

#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/problem/stop.h"

namespace carnot::internal {

struct RefinementOptions {
  double enough = 4e-2;  // change of the momenta, relative to the largest one, at which to stop
  int max_intervals = 1024;
  Stop stop;  // ends it with the grids that there are
};

struct Refinement {
  bool found = false;       // there is an extremal of the problem itself on a finer grid,
  bool settled = false;     // and it changes by little
  double change = 1;        // of the momenta in the last doubling, relative
  Path path;                // on the last but one grid, extrapolated
  int intervals = 0;        // of the last grid
  std::vector<Path> finer;  // the discrete extremals on the finer grids
};

// Of `path`, a discrete extremal of the problem on its rung.
Refinement refine(const MassLadder& ladder, const RefinementOptions& options, const Path& path);

// The path on a grid of half the step and one rung down, by cubic interpolation; multipliers
// linearly.
Path halved(const Path& path);

}  // namespace carnot::internal
