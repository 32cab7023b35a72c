#include "carnot/shooting/front/momentum_bound.h"

#include <algorithm>
#include <limits>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/rays/conjugate_time.h"

namespace carnot::internal {

double conjugate_bound(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const UnitMomenta& momenta,
                       double target,
                       int threads) {
  constexpr int kRays = 16;
  constexpr int kDoublings = 8;
  constexpr double kEnough = 0.02;
  const std::vector<Eigen::Vector3d> directions = momenta.directions(kRays);
  const auto all = [&](double w) {
    std::vector<char> earlier(2 * kRays, 0);
    parallel_for(2 * kRays, thread_count(threads), [&](int k) {
      const Ray ray(dynamics, from, momenta.momentum({directions[k / 2], k % 2 == 0 ? w : -w}));
      earlier[k] = conjugate_time(ray, 1.01 * target) <= target ? 1 : 0;
    });
    return std::all_of(earlier.begin(), earlier.end(), [](char x) { return x != 0; });
  };
  double low = 0;
  double high = 1 / target;
  bool found = all(high);
  for (int i = 0; i < kDoublings && !found; ++i) {
    low = high;
    high *= 2;
    found = all(high);
  }
  if (!found) return std::numeric_limits<double>::infinity();
  while (high - low > kEnough * high) {
    const double middle = 0.5 * (low + high);
    (all(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace carnot::internal
