// Targets for trials: drawn one by one, so that number i is the same whatever else is drawn.
#pragma once

#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/segment.h"
#include "carnot/shooting/manifold.h"

namespace carnot::apps {

// Positions within 3 of the origin in each coordinate, angles within pi, uniformly, brought to the
// manifold where there is one; drawn again where there is no such point, or a singularity of the
// coordinates parts it from the origin.
inline std::vector<double> random_target(const Segment& segment, std::uint64_t seed, int i) {
  constexpr double kReach = 3;
  std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  const std::vector<double> origin(segment.dof, 0.0);
  std::vector<double> to;
  do {
    to.clear();
    for (const Coordinate& coordinate : segment.info.configuration) {
      const double reach = coordinate.period > 0 ? std::numbers::pi : kReach;
      to.push_back(std::uniform_real_distribution<double>(-reach, reach)(random));
    }
  } while (!bring_to_manifold(segment, to.data()) ||
           segment.chart(origin.data()) * segment.chart(to.data()) < 0);
  return to;
}

}  // namespace carnot::apps
