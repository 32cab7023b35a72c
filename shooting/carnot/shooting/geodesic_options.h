// What may be asked of a search for geodesics beside its problem.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot {

struct GeodesicOptions {
  int count = 1;     // how many extremals are wanted
  bool all = false;  // every one found, instead of `count`
  double max_length = std::numeric_limits<double>::infinity();
  int starts = 0;  // paths to relax; 0: the default for what is asked
  // The largest endpoint error of a verified extremal, in the problem's own scales: those of a
  // wheelbase and of a turn, not of the unit that lengths happen to be in. The default is no less
  // than the last digit of the target.
  double tolerance = 1e-10;
  // The same in the units of the coordinates; takes the place of `tolerance` where it is given.
  std::optional<double> absolute_tolerance;
  std::string minimiser = "ceres";  // newton, ceres, nlopt, nlopt:NAME (see minimisers())
  bool mod_angles = false;          // angles need to agree modulo their periods only
  // p0 to start from instead of paths, with q_j(0) for free coordinates; empty: none.
  std::vector<double> guess;
  // Whether a strictly abnormal curve, which has no p0, is listed where it is shorter than all
  // else. Where not, and there is nothing else, the reason is kOnlyAbnormal.
  bool abnormal = true;
  std::uint64_t seed = 0;
  int threads = 0;  // 0: all cores
  // Seconds after which the search ends with what it has found. The answer of a search that was not
  // ended by it does not depend on it.
  double time_limit = std::numeric_limits<double>::infinity();
  long samples = 201;  // times in each trajectory; 0: none
  // Told the fraction done, and returns false to stop. It is called often, and by the thread that
  // searches only.
  Progress progress;

  // Throws std::invalid_argument naming the option and what is accepted.
  void validate(const BoundaryValueProblem& problem) const;
};

}  // namespace carnot
