// The straight line through points that fits them best, by least squares.
#pragma once

#include <limits>
#include <vector>

namespace carnot {

// What too few points do not tell is NaN.
struct LineFit {
  double slope = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();  // of the slope
  double correlation = std::numeric_limits<double>::quiet_NaN();
  int points = 0;
};

// The line through the points (x_i, y_i). Points of one x have none: its slope is NaN or infinite.
LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace carnot
