// The least action from one start to every point of a grid of targets.
//
// A few searches give extremals, each neighbour is reached from the one beside it by Newton's
// method (field/field_sweep.h), and what neighbours do not explain is searched again: some thousand
// points a second on each core, where searches alone solve some ten.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "carnot/shooting/find_geodesics.h"

namespace carnot {

// Equidistant values of a coordinate of the target. With mod_angles, values around a whole period
// leave out the repeated end.
struct FieldAxis {
  int coordinate = 0;
  std::vector<double> values;
};

struct FieldOptions {
  GeodesicOptions search;  // of the searches; `mod_angles` and `tolerance` are of the whole
  int threads = 0;         // 0: all cores
  long check = 100;        // points that are searched once more in the end, with another seed
  Progress progress;       // fraction of points known; returns false to stop
};

// Of all points, the first axis slowest. What is not known of a point is NaN.
struct Field {
  bool finished = false;  // false: stopped
  int dof = 0;
  std::vector<double> action;
  std::vector<double> p0;  // n of each point
  // Of an independent flow with twice as many steps. Where searches gave a point at knots only it
  // is the defect there.
  std::vector<double> error;
  std::vector<Verification> verification;
  std::vector<Label> label;    // that of the search that a point was reached from
  std::vector<Reason> reason;  // kNone where it is known

  long searches = 0;  // cold ones, without those of the check
  long pushes = 0;    // neighbours that promised less,
  long improved = 0;  // and that kept it
  long flows = 0;     // tangent flows
  long checked = 0;   // points searched again,
  long lower = 0;     // and where that found less by more than 1e-8, relative
  double bound = 1;   // of the share of such points, with 95 per cent confidence
  double elapsed_seconds = 0;
};

// `problem.to` gives the coordinates without an axis. For scenes with velocity constraints or
// driftless controls, and without a potential. Throws std::invalid_argument for other scenes, free
// ends, limits and axes that are empty or not equidistant. Memory: some
// 200 bytes a point with three coordinates, 300 with four, and the answer.
Field solve_field(const BoundaryValueProblem& problem,
                  const std::vector<FieldAxis>& axes,
                  const FieldOptions& options = {});

}  // namespace carnot
