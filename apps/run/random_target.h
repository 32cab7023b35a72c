// Targets for trials: drawn one by one, so that number i is the same whatever else is drawn.
#pragma once

#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/shooting/problem/manifold.h"

namespace carnot::apps {

// Positions within 3 of the origin in each coordinate, angles within pi, uniformly, brought to the
// manifold where there is one; drawn again where there is no such point, or a singularity of the
// coordinates parts it from the origin.
inline std::vector<double> random_target(const Dynamics& dynamics, std::uint64_t seed, int i) {
  constexpr double kReach = 3;
  std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  const std::vector<double> origin(dynamics.dof, 0.0);
  std::vector<double> to;
  do {
    to.clear();
    for (const Coordinate& coordinate : dynamics.info.configuration) {
      const double reach = coordinate.period > 0 ? std::numbers::pi : kReach;
      to.push_back(std::uniform_real_distribution<double>(-reach, reach)(random));
    }
  } while (!internal::bring_to_manifold(dynamics, to.data()) ||
           dynamics.chart(origin) * dynamics.chart(to) < 0);
  return to;
}

}  // namespace carnot::apps
