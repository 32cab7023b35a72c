#include "carnot/shooting/field/field_jumps.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace carnot::internal {
namespace {

struct Jump {
  long farther = -1;
  double size = 0;
};

std::vector<Jump> jumps_along(const FieldGrid& grid,
                              std::size_t axis,
                              std::span<const double> distances) {
  std::vector<Jump> jumps;
  for (long i = 0; i < grid.size(); ++i) {
    const long next = grid.step(i, axis, 1).index;
    if (next < 0) continue;
    const double size = std::abs(distances[next] - distances[i]);
    if (std::isfinite(size)) jumps.push_back({distances[next] > distances[i] ? next : i, size});
  }
  return jumps;
}

}  // namespace

std::vector<long> points_beyond_jumps(const FieldGrid& grid, std::span<const double> distances) {
  constexpr double kUsual = 0.9;  // of all are no larger
  constexpr double kFactor = 3;
  std::map<long, double> times;  // as large as usual
  for (std::size_t axis = 0; axis < grid.axes.size(); ++axis) {
    std::vector<Jump> jumps = jumps_along(grid, axis, distances);
    if (jumps.empty()) continue;
    const auto at = jumps.begin() + static_cast<long>(kUsual * static_cast<double>(jumps.size()));
    std::nth_element(jumps.begin(), at, jumps.end(), [](const Jump& a, const Jump& b) {
      return a.size < b.size;
    });
    const double usual = at->size;
    for (const Jump& jump : jumps) {
      if (!(jump.size > kFactor * usual)) continue;
      double& most = times[jump.farther];
      most = std::max(most, jump.size / usual);
    }
  }
  std::vector<long> points;
  points.reserve(times.size());
  for (const auto& [i, most] : times) points.push_back(i);
  std::stable_sort(
      points.begin(), points.end(), [&times](long a, long b) { return times.at(a) > times.at(b); });
  return points;
}

}  // namespace carnot::internal
