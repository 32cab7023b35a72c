#include "carnot/shooting/path/homotopy.h"

#include <algorithm>
#include <utility>

namespace carnot::internal {
namespace {

// a + ahead (a - before), entry by entry.
std::vector<double> extrapolated(const std::vector<double>& before,
                                 const std::vector<double>& a,
                                 double ahead) {
  std::vector<double> result = a;
  for (std::size_t j = 0; j < a.size(); ++j) result[j] += ahead * (a[j] - before[j]);
  return result;
}

}  // namespace

bool follow(const HomotopyOptions& options,
            const std::function<bool(double s, Path& trial)>& correct,
            Path& path) {
  constexpr double kGrow = 1.6;
  constexpr double kShrink = 0.4;
  constexpr double kLeast = 1e-5;
  Path before = path;
  double reached = 0;
  double last = 0;  // the length of the step that led there
  double step = options.first_step;
  for (int count = 0; count < options.most_steps && step >= kLeast; ++count) {
    if (options.stop.reached()) break;
    if (count == options.patience && reached < options.hardly) break;
    const double next = std::min(1.0, reached + step);
    Path trial = path;
    if (last > 0) {
      trial.q = extrapolated(before.q, path.q, (next - reached) / last);
      trial.lambda = extrapolated(before.lambda, path.lambda, (next - reached) / last);
    }
    if (!correct(next, trial)) {
      step *= kShrink;
      continue;
    }
    last = next - reached;
    reached = next;
    before = std::exchange(path, std::move(trial));
    if (reached >= 1) return true;
    step *= kGrow;
  }
  return false;
}

}  // namespace carnot::internal
