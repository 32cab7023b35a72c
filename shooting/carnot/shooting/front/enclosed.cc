#include "carnot/shooting/front/enclosed.h"

#include <cmath>

namespace carnot::internal {

double enclosed_volume(const Dynamics& dynamics,
                       const Surface& surface,
                       const std::vector<double>& ends) {
  int x = 0;
  while (x < 2 && dynamics.info.configuration[x].period > 0) ++x;
  const auto at = [&](int i, int k) { return ends[static_cast<std::size_t>(i) * 3 + (x + k) % 3]; };
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const double area = (at(b, 1) - at(a, 1)) * (at(c, 2) - at(a, 2)) -
                        (at(b, 2) - at(a, 2)) * (at(c, 1) - at(a, 1));
    sum += area * (at(a, 0) + at(b, 0) + at(c, 0)) / 6;
  }
  return std::abs(sum);
}

double enclosed_area(const Dynamics& dynamics,
                     const Surface& surface,
                     const std::vector<double>& ends,
                     bool two_lines) {
  const int x = dynamics.info.configuration[0].period > 0 ? 1 : 0;
  const auto at = [&](int i, int k) { return ends[static_cast<std::size_t>(i) * 2 + k]; };
  double sum = 0;
  for (const auto& [a, b] : surface.segments) {
    const double flux = 0.5 * (at(a, x) + at(b, x)) * (at(b, 1 - x) - at(a, 1 - x));
    sum += two_lines && surface.vertices[a].place.c[0] < 0 ? -flux : flux;
  }
  return std::abs(sum);
}

}  // namespace carnot::internal
