// Targets for trials: drawn one by one, so that number i is the same whatever else is drawn.
#pragma once

#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/segment.h"

namespace carnot::apps {

// Positions within 3 of the origin in each coordinate, angles within pi, uniformly; drawn again
// where a singularity of the coordinates parts them from the origin.
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
  } while (segment.chart(origin.data()) * segment.chart(to.data()) < 0);
  return to;
}

}  // namespace carnot::apps
