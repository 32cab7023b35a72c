#include "carnot/shooting/field/field_sample.h"

#include <cmath>
#include <set>

namespace carnot::internal {

std::vector<long> evenly_spread_points(const FieldGrid& grid, long count) {
  const auto d = static_cast<double>(grid.axes.size());
  double root = 1.5;
  for (int i = 0; i < 50; ++i) root = std::pow(1 + root, 1 / (d + 1));
  std::set<long> points;
  for (long k = 0; k < count; ++k) {
    long index = 0;
    double power = 1;
    for (const FieldGrid::Axis& axis : grid.axes) {
      power /= root;
      const double x = 0.5 + static_cast<double>(k) * power;
      const auto size = static_cast<double>(axis.values.size());
      const auto at = static_cast<long>((x - std::floor(x)) * size);
      index = index * static_cast<long>(axis.values.size()) + at;
    }
    points.insert(index);
  }
  return {points.begin(), points.end()};
}

double upper_share(long found, long tried) {
  constexpr double kDoubt = 0.05;
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60 && found < tried; ++i) {
    const double share = 0.5 * (low + high);
    double term = std::pow(1 - share, static_cast<double>(tried));
    double sum = term;
    for (long k = 0; k < found; ++k) {
      term *= static_cast<double>(tried - k) / static_cast<double>(k + 1) * share / (1 - share);
      sum += term;
    }
    (sum > kDoubt ? low : high) = share;
  }
  return high;
}

}  // namespace carnot::internal
