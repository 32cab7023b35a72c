// Geodesics between two configurations, without a guess.
//
// What happens to one start, and where. The midpoint transcription tells a relaxed path its
// momenta, so that shooting needs no guess of p(0):
//
//   a wiggled straight line                              search/starts.h
//      |  relax      pull it tight, by least squares     path/relaxation.h
//   a path that nearly satisfies the constraints
//      |  tighten    Newton's method on the grid         path/discrete_newton.h
//   a discrete extremal
//      |  polish                                         search/polish.h
//      |    refine   on finer grids                      path/refinement.h
//      |    shoot    join flows from knot to knot        shoot/multiple_shooting.h
//      |    correct  Newton's method on p(0) alone       shoot/end_point.h
//      |    verify   integrate once more, and measure    extremal/verification.h
//   an extremal
//      |  complete   samples, conjugate times, label     extremal/classification.h
//   a Geodesic
//
// Where many starts do not agree, or more than the best is wanted, crossings of what is known are
// relaxed in turn with them (search/crossing.h). Two more ways lead in where the best extremal is
// no minimum, or where more than the best is wanted: ways down from saddles (path/descent.h) and
// near hits of random momenta (search/sweep.h). What they give is tightened and polished as well.
// Scenes with drift, and all others that are no least-squares problem, come to discrete extremals
// by other starts (search/drift_starts.h):
//
//   drift at another speed             |  a random path, and fictitious controls
//      |  carry    path/homotopy.h     |     |  reduce    path/action_descent.h
//   a discrete extremal                   a discrete extremal
//
// Where holonomic constraints need forces, random momenta are joined at knots and verified.
// search/search.h decides what is done next, and when it is enough. What is distinct is kept, least
// action first. All randomness comes from `seed`; the answer does not depend on the number of
// threads.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/geodesic_options.h"
#include "carnot/shooting/reason.h"

namespace carnot {

enum class GeodesicStatus { kConverged, kNotConverged, kInterrupted };

struct GeodesicReport {
  GeodesicStatus status = GeodesicStatus::kNotConverged;
  // Why nothing was found, as a code and in words with what to try. With mod_angles they are those
  // of the first image of the target. Where there are geodesics the words say whether coordinates
  // stood in the way of others; empty where they did not.
  Reason reason = Reason::kNone;
  std::string message;
  std::vector<Geodesic> geodesics;
  int starts = 0;
  int converged_starts = 0;
  int distinct_hit = 0;  // extremals, up to symmetry, that starts led to
  // How many more there may be, by Chao's estimate; at least one where the first of the list is no
  // minimum or was hit once only. Nothing where starts say too little for an estimate: with a
  // guess, and of scenes without a transcription, unless the least action was hit often and nothing
  // once only.
  std::optional<double> missed_estimate;
  double elapsed_seconds = 0;
};

// Throws std::invalid_argument on bad input; numerical failure is a status.
GeodesicReport find_geodesics(const BoundaryValueProblem& problem,
                              const GeodesicOptions& options = {});

// Names accepted by GeodesicOptions::minimiser.
std::vector<std::string> minimisers();

}  // namespace carnot
