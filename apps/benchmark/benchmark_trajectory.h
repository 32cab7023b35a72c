// The three initial value problems of `carnot benchmark`.
//
// The vehicles start at q = (1, 0.5, 0.3, 0.8) with x' = cos phi, y' = sin phi, theta' from the
// second constraint and phi' = 0.2; lambda = 0, so p = M q'. The paper's Heisenberg problem starts
// at q = 0 with p = (0.1, 0.3, 1).
#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "carnot/numerics/scalar.h"

namespace carnot::apps {

struct BenchmarkTrajectory {
  std::string_view scene;
  int dof = 0;
  double duration = 0;  // from t = 0
};

inline const std::vector<BenchmarkTrajectory>& benchmark_trajectories() {
  static const std::vector<BenchmarkTrajectory> kTrajectories = {
      {"vehicle-cosine", 4, 10}, {"vehicle", 4, 10}, {"heisenberg", 3, 100}};
  return kTrajectories;
}

// (q, p) at t = 0 to the precision of T: 0.3 is 3/10, not the double next to it.
template <class T>
std::vector<T> benchmark_start(const BenchmarkTrajectory& trajectory) {
  using std::cos, std::sin;
  const auto tenths = [](int n) { return T(constant<T>(n) / constant<T>(10)); };
  if (trajectory.dof == 3) return {T(0), T(0), T(0), tenths(1), tenths(3), T(1)};
  const T theta = tenths(3);
  const T phi = tenths(8);
  const T theta_dot = sin(T(phi - theta));
  return {T(1), tenths(5), theta, phi, T(cos(phi)), T(sin(phi)), theta_dot, tenths(2)};
}

}  // namespace carnot::apps
