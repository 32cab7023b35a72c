#include "carnot/shooting/front/momentum_bound.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "carnot/numerics/parallel.h"
#include "carnot/shooting/rays/first_conjugate.h"

namespace carnot::internal {

double conjugate_bound(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const Cylinder& cylinder,
                       double target,
                       int threads) {
  constexpr int kRays = 16;
  constexpr int kDoublings = 8;
  constexpr double kEnough = 0.02;
  const auto all = [&](double w) {
    std::vector<char> earlier(2 * kRays, 0);
    parallel_for(2 * kRays, thread_count(threads), [&](int k) {
      const double phi = 2 * std::numbers::pi * (k / 2 + 0.37) / kRays;
      const Ray ray(dynamics, from, cylinder.momentum(phi, k % 2 == 0 ? w : -w));
      earlier[k] = first_conjugate_time(ray, 1.01 * target) <= target ? 1 : 0;
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
