#include "carnot/numerics/line_fit.h"

#include <cmath>
#include <numeric>

namespace carnot {

LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y) {
  LineFit fit;
  fit.points = static_cast<int>(x.size());
  if (fit.points < 2) return fit;
  // Sums in order: Eigen's depend on where the values lie in memory, and so on the thread.
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / fit.points;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / fit.points;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  fit.slope = xy / xx;
  fit.correlation = xy / std::sqrt(xx * yy);
  if (fit.points > 2) {
    double rest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      rest += std::pow(y[i] - mean_y - fit.slope * (x[i] - mean_x), 2);
    }
    fit.standard_error = std::sqrt(rest / (xx * (fit.points - 2)));
  }
  return fit;
}

}  // namespace carnot
