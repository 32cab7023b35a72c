#include "carnot/shooting/problem/scales.h"

#include <algorithm>
#include <cmath>

namespace carnot::internal {

StartScales start_scales(const BoundaryValueProblem& problem) {
  const Dynamics& dynamics = problem.dynamics;
  const int n = dynamics.dof;
  const int k = dynamics.transcribed;
  std::vector<double> step(n), middle(n), unit(n), terms(n + k + 1);
  const auto length_of = [&](const std::vector<double>& v) {
    double sum = 0;
    if (!dynamics.midpoint(middle, v, terms)) return 0.0;
    for (int j = 0; j < n; ++j) sum += terms[j] * terms[j];
    return std::sqrt(sum);
  };
  StartScales scales;
  for (int j = 0; j < n; ++j) step[j] = problem.to[j] - problem.from[j];
  constexpr int kSamples = 8;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < n; ++j) middle[j] = problem.from[j] + (i + 0.5) / kSamples * step[j];
    scales.distance = std::max(scales.distance, length_of(step));
    for (int j = 0; j < k; ++j) scales.violation += terms[n + j] * terms[n + j] / kSamples;
  }
  scales.violation = std::sqrt(scales.violation);
  double radian2 = 0;
  int angles = 0;
  for (int j = 0; j < n; ++j) {
    std::fill(unit.begin(), unit.end(), 0.0);
    unit[j] = 1;
    const double length = std::max(length_of(unit), 1e-300);
    scales.per_metre.push_back(1 / length);
    if (dynamics.info.configuration[j].period > 0) {
      radian2 += length * length;
      ++angles;
    }
  }
  if (angles > 0) scales.radian = std::sqrt(radian2 / angles);
  return scales;
}

bool has_only_angles(const Dynamics& dynamics) {
  const auto& coordinates = dynamics.info.configuration;
  return std::all_of(coordinates.begin(),
                     coordinates.begin() + dynamics.dof,
                     [](const Coordinate& coordinate) { return coordinate.period > 0; });
}

}  // namespace carnot::internal
