// The order of a method as the slope of log(error) over log(step).
#pragma once

#include <cmath>
#include <vector>

#include "carnot/numerics/line_fit.h"

namespace carnot::test {

// Uses the points with plateau < error < ceiling: below the plateau is round-off, above the ceiling
// the leading term does not rule yet.
inline LineFit fit_order(const std::vector<double>& step,
                         const std::vector<double>& error,
                         double plateau,
                         double ceiling) {
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < step.size(); ++i) {
    if (error[i] <= plateau || error[i] >= ceiling) continue;
    x.push_back(std::log(step[i]));
    y.push_back(std::log(error[i]));
  }
  return fit_line(x, y);
}

}  // namespace carnot::test
