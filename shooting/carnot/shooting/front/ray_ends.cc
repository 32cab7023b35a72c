#include "carnot/shooting/front/ray_ends.h"

#include <algorithm>

#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

std::vector<double> ray_ends(const Dynamics& dynamics,
                             const std::vector<double>& from,
                             const std::vector<std::vector<double>>& momenta,
                             const std::vector<std::vector<double>>& longest,
                             double t,
                             int threads) {
  constexpr double kTolerance = 1e-12;
  const int n = dynamics.dof;
  const auto count = static_cast<int>(momenta.size());
  std::vector<double> z;
  z.reserve(momenta.size() * 2 * n);
  for (const std::vector<double>& p : momenta) {
    z.insert(z.end(), from.begin(), from.end());
    z.insert(z.end(), p.begin(), p.end());
  }
  if (dynamics.has_adaptive_batch()) {
    (void)dynamics.adaptive_batch(0, t, kTolerance, count, z, threads);
  } else {
    long steps = 1;
    for (const std::vector<double>& p : longest) {
      steps = std::max(steps, Ray(dynamics, from, p).enough_steps(t));
    }
    (void)dynamics.flow_batch(StepPlan::equal(0, t, steps), count, z, threads);
  }
  std::vector<double> ends;
  ends.reserve(momenta.size() * n);
  for (int k = 0; k < count; ++k) {
    const auto q = z.begin() + static_cast<long>(k) * 2 * n;
    ends.insert(ends.end(), q, q + n);
  }
  return ends;
}

}  // namespace carnot::internal
