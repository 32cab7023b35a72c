#include "carnot/shooting/path/path.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "carnot/shooting/path/path_lagrangian.h"

namespace carnot::internal {

void fill_momenta(const Dynamics& dynamics, double h, Path& path) {
  const int n = dynamics.dof;
  path.p.assign(path.q.size(), 0);
  PathLagrangian(dynamics, h).visit(path, false, [&](int i, const PathLagrangian::Terms& terms) {
    const double at_left = i == 0 ? 1 : 0.5;
    const double at_right = i + 1 == path.intervals ? 1 : 0.5;
    for (int j = 0; j < n; ++j) {
      path.p[i * n + j] -= at_left * terms.gradient[j];
      path.p[(i + 1) * n + j] += at_right * terms.gradient[n + j];
    }
  });
}

bool same_chart(const Dynamics& dynamics, const double* a, const double* b) {
  const auto n = static_cast<std::size_t>(dynamics.dof);
  return dynamics.chart({a, n}) * dynamics.chart({b, n}) > 0;
}

bool in_one_chart(const Dynamics& dynamics, const Path& path) {
  for (int i = 0; i < path.intervals; ++i) {
    if (!same_chart(dynamics, path.configuration(i), path.configuration(i + 1))) return false;
  }
  return true;
}

bool skims_chart_end(const Dynamics& dynamics, const Path& path) {
  constexpr double kFactor = 2.5;
  constexpr double kBelowEnds = 0.5;
  if (!in_one_chart(dynamics, path)) return false;
  const auto chart = [&](int i) {
    return std::abs(dynamics.chart(std::span(path.configuration(i), path.dof)));
  };
  const double ends = std::min(chart(0), chart(path.intervals));
  for (int i = 0; i < path.intervals; ++i) {
    const double here = chart(i);
    const double next = chart(i + 1);
    const double nearer = std::min(here, next);
    if (nearer < kBelowEnds * ends && std::max(here, next) > kFactor * nearer) return true;
  }
  return false;
}

double discrete_action(const Dynamics& dynamics, double h, const Path& path) {
  return PathLagrangian(dynamics, h).action(path);
}

void Path::gather(int i, int multipliers, double* x) const {
  std::copy(configuration(i), configuration(i) + 2 * dof, x);
  std::copy(lambda.data() + i * multipliers, lambda.data() + (i + 1) * multipliers, x + 2 * dof);
}

}  // namespace carnot::internal
