// Starts of a search: paths that are relaxed and tightened, as many side by side as there are
// lanes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/problem/stop.h"
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

// One of the sequence of starts (starts.h), on a grid.
struct StartDraw {
  int number = 0;
  int intervals = 32;

  friend bool operator==(const StartDraw&, const StartDraw&) = default;
};

struct RelaxedStartOptions {
  std::uint64_t seed = 0;
  int stiffness = 0;  // how often the penalty is raised before the first attempt
  int threads = 1;
  Stop stop;  // what begins later is not found
};

// Starts that go side by side, by their indices: those of one rung and grid, as many as there are
// lanes, or fewer where there are threads without a pack.
using StartPack = std::vector<std::size_t>;
std::vector<StartPack> packs_of(std::span<const Start> starts, int threads);

// Relaxes and tightens starts of any origin, each on the rung that its path names. What becomes of
// one does not depend on the others, nor on the number of threads.
std::vector<RelaxedStart> relaxed(const MassLadder& ladder,
                                  const RelaxedStartOptions& options,
                                  std::span<const Start> starts);

// The same for starts of the sequence. Where there is a near target, the paths are relaxed to the
// easy problem in its stead and then shrunk.
std::vector<RelaxedStart> relaxed_starts(const MassLadder& ladder,
                                         const std::optional<NearTarget>& near,
                                         const RelaxedStartOptions& options,
                                         std::span<const StartDraw> draws);

}  // namespace carnot::internal
