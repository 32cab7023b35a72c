// Geodesics of problems with limits.
//
//   the extremals without limits, and wiggled lines    search/starts.h
//      |  relax    what is beyond a wall costs            path/relaxation.h
//   a path
//      |  solve    slacks and multipliers on the grid     path/interior_point.h
//   a discrete extremal with limits, perhaps of a heavier problem
//      |  go down  to the problem itself                  problem/mass_ladder.h
//   the list of these                                     search/candidate_list.h
//      |  refine   on finer grids                         search/limited_finish.h
//      |  join     arcs on walls and points of contact    shoot/bound_arcs.h
//   an extremal, flows piece by piece
//
// An extremal without limits that keeps to them anyway is one of the problem and is left as it is.
// Where no pieces join, such as on the border of an obstacle that a wheel cannot follow to first
// order, the answer is the path on the finest grid, and says so. Every answer has been checked for
// what is beyond a limit at many times.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/reason.h"

namespace carnot::internal {

struct LimitedAnswer {
  std::vector<Geodesic> geodesics;  // least action first; no more than are wanted
  int starts = 0;
  int converged = 0;
  bool finished = true;
  bool timed_out = false;
  Reason reason = Reason::kNone;
  std::string message;
};

// Why the ends themselves are beyond a limit; empty: they are not.
std::string beyond_limit_at_end(const BoundaryValueProblem& problem);

// Whether a geodesic without limits keeps to them anyway.
bool is_within_limits(const BoundaryValueProblem& problem, const Geodesic& geodesic);

// `free` are the geodesics without limits that were found, least action first.
LimitedAnswer search_with_limits(const BoundaryValueProblem& problem,
                                 const GeodesicOptions& options,
                                 const std::vector<Geodesic>& free);

}  // namespace carnot::internal
