// Geodesics between two configurations, without a guess.
//
// starts.h makes paths, relaxation.h pulls each tight on the midpoint transcription and reads off a
// discrete costate, multiple_shooting.h polishes it at the order of the method, verification.h
// checks the result by an independent forward integration. What is distinct is kept, least action
// first. All randomness comes from `seed`; the answer does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/reason.h"

namespace carnot {

enum class Verification { kSingle, kKnots };
enum class Label { kLocallyMinimal, kConjugatePassed, kSingular, kUnknown };

// An extremal that joins the two configurations, checked.
struct Geodesic {
  std::vector<double> p0;
  std::vector<double> lambda0;
  double action = 0;
  std::optional<double> length;  // where the scene has a mass matrix
  Verification verification = Verification::kSingle;
  double endpoint_error = 0;  // max-norm of q(T) - to; of an independent integration
  double knot_defect = 0;     // max-norm of flow(z_i) - z_{i+1}, for kKnots
  double constraint_error = 0;
  double energy_drift = 0;
  std::optional<std::vector<double>> conjugate_times;  // in (0, T], by multiplicity; if known
  Label label = Label::kUnknown;
  std::optional<bool> abnormal;  // if known
  std::optional<int> morse_index;
  std::optional<int> family_dimension;
  std::vector<std::pair<std::string, double>> extremes;  // e.g. largest_steering_angle
  StepPlan plan;                                         // steps of the verified integration
  int hits = 0;               // starts that led here or to a mirror partner
  std::vector<int> windings;  // whole periods added to the target, with mod_angles
  Trajectory trajectory;
};

struct GeodesicOptions {
  int count = 1;     // how many extremals are wanted
  bool all = false;  // every one found, instead of `count`
  double max_length = std::numeric_limits<double>::infinity();
  int starts = 0;                    // paths to relax; 0: the default for what is asked
  double tolerance = 1e-10;          // largest endpoint error of a verified extremal
  std::string minimiser = "newton";  // newton, ceres, nlopt, nlopt:NAME (see minimisers())
  bool mod_angles = false;           // angles need to agree modulo their periods only
  std::vector<double> guess;         // p0 to start from instead of paths; empty: none
  std::uint64_t seed = 0;
  int threads = 0;     // 0: all cores
  long samples = 201;  // times in each trajectory; 0: none
  Progress progress;   // fraction done; returns false to stop

  // Throws std::invalid_argument naming the option and what is accepted.
  void validate(const BoundaryValueProblem& problem) const;
};

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
