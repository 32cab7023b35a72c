#include "carnot/shooting/search/momentum_starts.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "carnot/shooting/problem/manifold.h"
#include "carnot/shooting/problem/reach.h"

namespace carnot::internal {
std::vector<double> momentum_start(const BoundaryValueProblem& problem, std::uint64_t seed, int i) {
  constexpr double kSmallest = 0.1;
  constexpr double kLargest = 10;
  const int n = problem.dynamics.dof;
  std::vector<double> p = straight_momentum(problem);
  if (i > 0) {
    double size = 0;
    for (int j = 0; j < n; ++j) {
      const double distance = std::abs(problem.to[j] - problem.from[j]) / problem.time;
      size = std::max({size, std::abs(p[j]), distance});
    }
    std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
    std::mt19937_64 random(sequence);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> magnitude(std::log(kSmallest), std::log(kLargest));
    const double factor = size * std::exp(magnitude(random));
    for (double& x : p) x = factor * normal(random);
  }
  if (problem.dynamics.forced > 0 && !bring_to_manifold(problem, p)) return {};
  for (int j = 0; j < n; ++j) {
    if (problem.is_free_from(j)) p[j] = problem.from[j];
  }
  return p;
}

}  // namespace carnot::internal
