// The Euclidean norm and distance of plain arrays.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

namespace carnot::internal {

inline double norm(std::span<const double> x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum);
}

// Of two of the same length.
inline double distance(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return std::sqrt(sum);
}

}  // namespace carnot::internal
