// carnot benchmark --boundary-value: who finds geodesics from blind starts, and at what price.
//
// Blind starts know the two ends and nothing else. A path is that of starts.h, for our minimisers
// relaxed and tightened first (relaxation.h, discrete_newton.h), for IPOPT as it is; a momentum is
// that of momentum_starts.h, for our minimisers on several knots, for GSL as it is. What a solver
// of the equations delivers counts when an independent integration arrives within the tolerance;
// a direct transcription has only its own word and the error of its grid.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::apps {

struct BoundaryOptions {
  int starts = 64;   // of each solver on each problem
  int targets = 20;  // of the curve, each with kCurveStarts starts
  std::uint64_t seed = 0;
  int threads = 0;  // 0: all cores
};

inline constexpr int kCurveStarts = 64;

// What became of one start. `action` counts where it is solved.
struct BoundaryTrial {
  bool solved = false;
  double action = std::numeric_limits<double>::infinity();
  double seconds = 0;  // of CPU
};

enum class BoundaryStart { kPath, kMomentum };

// A solver of the table. run(problem, seed, i) uses start i.
struct BoundarySolver {
  std::string name;
  BoundaryStart start = BoundaryStart::kPath;
  bool peer = false;
  bool verified = true;     // by an independent integration; else the solver's own word
  bool in_parallel = true;  // may run on several threads at once
  std::function<BoundaryTrial(const BoundaryValueProblem&, std::uint64_t, int)> run;
};

struct BoundaryRow {
  std::string scene;
  std::string solver;
  BoundaryStart start = BoundaryStart::kPath;
  bool peer = false;
  bool verified = true;
  int starts = 0;
  int solved = 0;
  int least_found = 0;                      // how often the least action
  double cpu_seconds = 0;                   // of all the starts
  std::optional<double> best_action_error;  // relative to the least action known
};

// One point of the curve: after so many starts at each of the targets.
struct BoundaryPoint {
  std::string scene;
  int starts = 0;
  int targets = 0;
  int solved = 0;          // targets
  int least = 0;           // targets at the least action that kCurveStarts starts find
  double cpu_seconds = 0;  // of a start, in the mean
};

struct BoundaryProblemEntry {
  std::string scene;
  std::vector<double> to;   // from the origin, T = 1
  double least_action = 0;  // known, or found if less
};

struct BoundaryResult {
  std::vector<BoundaryProblemEntry> problems;
  std::vector<BoundaryRow> rows;
  std::vector<BoundaryPoint> curve;
};

// newton, ceres, nlopt:..., from paths and from momenta.
std::vector<BoundarySolver> own_boundary_solvers();

// Nothing when stopped.
std::optional<BoundaryResult> run_boundary_benchmark(const BoundaryOptions& options,
                                                     const std::vector<BoundarySolver>& solvers,
                                                     const Progress& progress);

}  // namespace carnot::apps
