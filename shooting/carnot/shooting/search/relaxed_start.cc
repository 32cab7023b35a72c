#include "carnot/shooting/search/relaxed_start.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/linear/chain_least_squares.h"
#include "carnot/shooting/path/newton_lanes.h"
#include "carnot/shooting/path/relaxation.h"

namespace carnot::internal {
namespace {

double largest_momentum(const Path& path) {
  double largest = std::numeric_limits<double>::min();
  for (const double p : path.p) largest = std::max(largest, std::abs(p));
  return largest;
}

// Relaxes and tightens starts on grids of one size; what their ends are is in their paths.
void relax_pack(const BoundaryValueProblem& problem,
                int stiffness,
                const std::vector<const Start*>& starts,
                const std::vector<RelaxedStart*>& results) {
  // A path may collapse to the straight line, which violates the constraints, or be on its way
  // there. A stiffer penalty holds it.
  constexpr double kCollapsed = 0.5;
  constexpr double kHeld = 0.02;
  constexpr int kAttempts = 3;
  constexpr double kStiffer = 8;
  std::vector<std::size_t> open(starts.size());
  std::iota(open.begin(), open.end(), 0);
  for (int attempt = 0; attempt < kAttempts && !open.empty(); ++attempt) {
    std::vector<RelaxationTask> pulls;
    for (const std::size_t i : open) {
      results[i]->path = starts[i]->path;
      pulls.push_back({starts[i]->relaxation, &results[i]->path, {}});
      pulls.back().options.penalty *= std::pow(kStiffer, stiffness + attempt);
    }
    relax(problem, pulls);
    std::vector<Path> paths;
    std::vector<TighteningTask> tightenings;
    paths.reserve(open.size());
    for (std::size_t a = 0; a < open.size(); ++a) {
      if (!(pulls[a].result.violation < kCollapsed)) continue;
      paths.push_back(results[open[a]]->path);
      tightenings.push_back({&paths.back(), {}});
    }
    tighten(problem, {}, tightenings);
    std::vector<std::size_t> again;
    std::size_t next = 0;
    for (std::size_t a = 0; a < open.size(); ++a) {
      RelaxedStart& result = *results[open[a]];
      result.stiffness = attempt + 1;
      const double violation = pulls[a].result.violation;
      if (!(violation < kCollapsed)) {
        again.push_back(open[a]);
        continue;
      }
      Path& path = paths[next];
      const DiscreteNewton& tightened = tightenings[next++].result;
      result.blocked = tightened.left_chart || skims_chart_end(problem.dynamics, path);
      result.found = tightened.converged && !result.blocked;
      result.relaxed = !result.blocked;
      result.residual = tightened.residual / largest_momentum(path);
      if (result.found) result.path = std::move(path);
      if (result.found || violation < kHeld || attempt > 0) {
        result.stiffness = attempt;
      } else {
        again.push_back(open[a]);
      }
    }
    open = std::move(again);
  }
}

}  // namespace

std::vector<StartPack> packs_of(std::span<const Start> starts, int threads) {
  const auto count = static_cast<int>(starts.size());
  // Three times as many as there are lanes: a lane that is done early takes up another one, and
  // those that need a stiffer penalty are more at a time. Starts of sideways parking take 249 us
  // each in packs of twice as many as there are lanes, 328 us in packs of as many. Whole searches
  // of 24 starts in one pack take 0.88 (unicycle) to 0.93 (vehicle) of those in one of 16 and one
  // of 8.
  constexpr int kMost = 3 * kChainLanes;
  const int most = std::clamp((count + threads - 1) / threads, 1, kMost);
  std::map<std::pair<int, int>, StartPack> growing;
  std::vector<StartPack> packs;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    StartPack& pack = growing[{starts[i].path.rung, starts[i].path.intervals}];
    pack.push_back(i);
    if (static_cast<int>(pack.size()) == most) packs.push_back(std::exchange(pack, {}));
  }
  for (auto& [key, pack] : growing) {
    if (!pack.empty()) packs.push_back(std::move(pack));
  }
  return packs;
}

std::vector<RelaxedStart> relaxed(const MassLadder& ladder,
                                  const RelaxedStartOptions& options,
                                  std::span<const Start> starts) {
  std::vector<RelaxedStart> results(starts.size());
  const std::vector<StartPack> packs = packs_of(starts, options.threads);
  parallel_for(static_cast<int>(packs.size()), options.threads, [&](int p) {
    if (options.stop.reached()) return;
    std::vector<const Start*> side_by_side;
    std::vector<RelaxedStart*> into;
    for (const std::size_t i : packs[p]) {
      side_by_side.push_back(&starts[i]);
      into.push_back(&results[i]);
    }
    const int rung = side_by_side.front()->path.rung;
    relax_pack(ladder.on(rung), options.stiffness, side_by_side, into);
  });
  return results;
}

std::vector<RelaxedStart> relaxed_starts(const MassLadder& ladder,
                                         const std::optional<NearTarget>& near,
                                         const RelaxedStartOptions& options,
                                         std::span<const StartDraw> draws) {
  const auto count = static_cast<int>(draws.size());
  std::vector<Start> starts(draws.size());
  std::map<int, StartScales> scales;  // on each rung
  for (const auto& [number, intervals] : draws) {
    const int rung = ladder.rung_of(number, intervals);
    if (!near && scales.count(rung) == 0) scales[rung] = start_scales(ladder.on(rung));
  }
  parallel_for(count, options.threads, [&](int i) {
    const auto& [number, intervals] = draws[i];
    if (near) {
      starts[i] = make_start(near->easy(near->way(number)), options.seed, number, intervals);
      return;
    }
    const int rung = ladder.rung_of(number, intervals);
    starts[i] = make_start(ladder.on(rung), scales.at(rung), options.seed, number, intervals);
    starts[i].path.rung = rung;
  });
  std::vector<RelaxedStart> results = relaxed(ladder, options, starts);
  if (!near) return results;
  parallel_for(count, options.threads, [&](int i) {
    results[i].relaxed = false;
    const NearTarget::Way way = near->way(draws[i].number);
    if (results[i].found) results[i].found = near->shrink(way, results[i].path);
  });
  return results;
}

}  // namespace carnot::internal
