// Geodesics between two configurations, without a guess.
//
// starts.h makes paths, relaxation.h pulls each tight on the midpoint transcription and reads off a
// discrete costate, multiple_shooting.h polishes it at the order of the method, verification.h
// checks the result by an independent forward integration. What is distinct is kept, least action
// first. All randomness comes from `seed`; the answer does not depend on the number of threads.
#pragma once

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
  Reason reason = Reason::kNone;  // why nothing was found; the first image's with mod_angles,
  std::string message;            // in words, and what to try
  std::vector<Geodesic> geodesics;
  int starts = 0;
  int converged_starts = 0;
  int distinct_hit = 0;        // extremals, up to symmetry, that starts led to,
  double missed_estimate = 0;  // and how many more there may be, by Chao's estimate
  double elapsed_seconds = 0;
};

// Throws std::invalid_argument on bad input; numerical failure is a status.
GeodesicReport find_geodesics(const BoundaryValueProblem& problem,
                              const GeodesicOptions& options = {});

// Names accepted by GeodesicOptions::minimiser.
std::vector<std::string> minimisers();

}  // namespace carnot
