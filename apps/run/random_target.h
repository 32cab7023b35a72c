// Targets for trials: drawn one by one, so that number i is the same whatever else is drawn.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "carnot/dynamics.h"
#include "carnot/scene/limit.h"
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

// Where the motion from the origin ends after time 1, with a random momentum whose entries are
// normal. Empty where none of many can be followed.
inline std::vector<double> reachable_target(const Dynamics& dynamics, std::uint64_t seed, int i) {
  constexpr int kDraws = 100;
  constexpr long kSteps = 64;
  std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
  std::mt19937_64 random(sequence);
  std::normal_distribution<double> normal;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<double> z(2 * dynamics.dof, 0.0);
    for (int j = 0; j < dynamics.dof; ++j) z[dynamics.dof + j] = normal(random);
    if (!dynamics.flow(StepPlan::equal(0, 1, kSteps), z).completed()) continue;
    return {z.begin(), z.begin() + dynamics.dof};
  }
  return {};
}

// The target of trial i: one that can be reached where there is drift, else any; drawn again until
// it keeps to the limits.
inline std::vector<double> trial_target(const Dynamics& dynamics,
                                        const std::vector<Limit>& limits,
                                        std::uint64_t seed,
                                        int i) {
  constexpr std::uint64_t kMostDrawn = 1000;
  const bool drifts = !dynamics.has_transcription() && dynamics.holonomic == 0;
  std::vector<double> to;
  for (std::uint64_t k = 0; k < kMostDrawn; ++k) {
    const std::uint64_t other = seed + (k << 32U);
    to = drifts ? reachable_target(dynamics, other, i) : random_target(dynamics, other, i);
    const bool kept = std::all_of(limits.begin(), limits.end(), [&](const Limit& limit) {
      return limit.slack(limit.value(to.data(), nullptr, nullptr)) >= 0;
    });
    if (to.empty() || kept) break;
  }
  return to;
}

}  // namespace carnot::apps
