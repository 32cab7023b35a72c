#include "carnot/shooting/search/abnormal_search.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/extremal/abnormal_curve.h"
#include "carnot/shooting/search/search.h"

namespace carnot::internal {

std::optional<Extremal> abnormal_extremal(const BoundaryValueProblem& problem,
                                          const GeodesicOptions& options,
                                          const Search& search) {
  // A path that was pulled tight violates the constraints a little, and is shorter for it.
  constexpr double kClearly = 0.98;
  constexpr double kShorter = 1 - 1e-9;
  if (!search.seeks_abnormal()) return std::nullopt;
  double longest = options.max_length;
  for (const Extremal& found : search.extremals()) {
    if (!(search.least_relaxed() < kClearly * found.geodesic.action)) return std::nullopt;
    const double length = std::sqrt(2 * problem.time * found.geodesic.action);
    longest = std::min(longest, kShorter * length);
  }
  const auto curve = abnormal_curve(problem, longest, options.tolerance);
  if (!curve) return std::nullopt;
  Extremal abnormal = extremal_of(problem, *curve, options.samples);
  if (const auto p0 = normal_momentum(problem, *curve)) {
    const Knots knots = knots_of(problem, *p0, 1, curve->steps);
    auto normal = verify(problem, knots, curve->steps, options.tolerance).extremal;
    if (normal && same(*normal, abnormal)) return normal;
  }
  return abnormal;
}

}  // namespace carnot::internal
