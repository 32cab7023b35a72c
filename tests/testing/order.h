// The order of a method as the slope of log(error) over log(step).
#pragma once

#include <cmath>
#include <vector>

namespace carnot::test {

struct LineFit {
  double slope = 0;
  double correlation = 0;
  int points = 0;
};

// Least squares line through (x, y).
inline LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  const auto count = static_cast<double>(x.size());
  double mean_x = 0;
  double mean_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / count;
    mean_y += y[i] / count;
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  return {xy / xx, xy / std::sqrt(xx * yy), static_cast<int>(x.size())};
}

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
