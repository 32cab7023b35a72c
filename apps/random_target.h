// Targets for trials: drawn one by one, so that number i is the same whatever else is drawn.
#pragma once

#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/scene_info.h"

namespace carnot::apps {

// Positions within 3 of the origin in each coordinate, angles within pi, uniformly.
inline std::vector<double> random_target(const SceneInfo& info, std::uint64_t seed, int i) {
  constexpr double kReach = 3;
  std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  std::vector<double> to;
  for (const Coordinate& coordinate : info.configuration) {
    const double reach = coordinate.period > 0 ? std::numbers::pi : kReach;
    to.push_back(std::uniform_real_distribution<double>(-reach, reach)(random));
  }
  return to;
}

}  // namespace carnot::apps
