// One start of a search: a path that is relaxed and tightened.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/search/near_target.h"
#include "carnot/shooting/search/starts.h"

namespace carnot::internal {

struct RelaxedStart {
  bool found = false;    // the path satisfies the discrete equations,
  bool relaxed = false;  // or it joins the ends of the problem and nearly satisfies them
  bool blocked = false;  // the coordinates end where the path went
  int stiffness = 0;     // how often the penalty had to be raised
  double residual = std::numeric_limits<double>::infinity();  // relative to the momenta
  Path path;
};

struct RelaxedStartOptions {
  std::uint64_t seed = 0;
  int intervals = 32;
  int stiffness = 0;  // how often the penalty is raised before the first attempt
};

// Start `i` of the sequence (starts.h). Where there is a near target, the path is relaxed to the
// easy problem in its stead and then shrunk.
RelaxedStart relaxed_start(const MassLadder& ladder,
                           const std::optional<NearTarget>& near,
                           const RelaxedStartOptions& options,
                           int i);

// The same from a start of any origin, without a near target. The penalty is raised `stiffness`
// times before the first attempt.
RelaxedStart relaxed(const BoundaryValueProblem& problem, const Start& start, int stiffness);

}  // namespace carnot::internal
