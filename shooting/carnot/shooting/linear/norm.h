// The Euclidean norm of plain arrays.
#pragma once

#include <cmath>
#include <span>

namespace carnot::internal {

inline double norm(std::span<const double> x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace carnot::internal
