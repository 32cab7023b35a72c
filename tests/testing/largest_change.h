// How far apart two lists of numbers are.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "carnot/numerics/scalar.h"

namespace carnot::test {

// The largest difference of an entry, NaN where there is one. Of lists of one length.
inline double largest_change(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = maximum(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace carnot::test
