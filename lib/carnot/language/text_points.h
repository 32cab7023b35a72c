// What the functions of a system from text share: its points as groups of a tape, and checks.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "carnot/language/text_newton.h"
#include "carnot/language/text_system.h"
#include "carnot/scene/chart.h"

namespace carnot::language {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr int kLanes = kErasedLanes;
static_assert(kLanes == kTapeLanes);
inline constexpr int kMostChecks = 64;
inline constexpr int kMostMultipliers = 2 * kMostDof;
// Numbers that nobody reads: of groups that a tape depends on for results that are not wanted.
inline constexpr std::array<double, kMostCoordinates * kLanes> kIdle{};

using Groups = TextEquations::Groups;

inline const TextBound& bound(const void* opaque) { return *static_cast<const TextBound*>(opaque); }
inline const TextSystem& system_of(const void* opaque) { return *bound(opaque).system; }

// The groups of one phase point, z = (q, p).
inline Groups at(const TextSystem& s,
                 const double& t,
                 const double* z,
                 const double* y = kIdle.data()) {
  return {&t, z, z + s.dof, y, kIdle.data(), kIdle.data()};
}
inline Groups at(const double& t, const double* q, const double* p, const double* y) {
  return {&t, q, p, y, kIdle.data(), kIdle.data()};
}
inline Groups at_velocity(const double& t, const double* q, const double* v, const double* lambda) {
  return {&t, q, kIdle.data(), kIdle.data(), v, lambda};
}

inline bool all_finite(const double* x, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += 0 * x[i];
  return sum == 0;
}

// The first check that fails, of values at one point.
inline RateStatus status_of_checks(const std::vector<RateStatus>& statuses, const double* values) {
  for (std::size_t i = 0; i < statuses.size(); ++i) {
    if (values[i] > 0) continue;
    return std::isfinite(values[i]) ? statuses[i] : RateStatus::kNotFinite;
  }
  return RateStatus::kOk;
}

inline bool regular_chart(const TextSystem& s, const double* q) {
  if (!s.has_chart) return true;
  double value = 0;
  const double t = 0;
  const std::array<double*, 1> out{&value};
  s.chart.run(at(t, q, kIdle.data(), kIdle.data()), out);
  return std::abs(value) > kNearSingularChart;
}

inline TextEquations equations_at(const TextSystem& s, const Groups& groups) {
  const int m = s.algebraic;
  TextEquations equations(s.linear ? s.hessian : s.equations, s.hessian, groups, s.dof, m, m, true);
  if (s.has_guess && !s.linear) equations.begin_at(s.guess);
  return equations;
}

struct OffManifold {
  double position = 0;  // max |h(q)|
  double velocity = 0;  // max |Dh v|
};

inline OffManifold off_manifold(const TextSystem& s,
                                const double& t,
                                const double* q,
                                const double* v) {
  std::array<double, kMostDof> h;
  std::array<double, kMostDof * kMostDof> dh;
  s.holonomic.run(at(t, q, kIdle.data(), kIdle.data()),
                  std::array<double*, 2>{h.data(), dh.data()});
  OffManifold off;
  for (int i = 0; i < s.holonomic_count; ++i) {
    double rate = 0;
    for (int j = 0; j < s.dof; ++j) rate += dh[i * s.dof + j] * v[j];
    off.position = std::max(off.position, std::abs(h[i]));
    off.velocity = std::max(off.velocity, std::abs(rate));
  }
  return off;
}

inline double largest(const double* x, int count) {
  double most = 0;
  for (int i = 0; i < count; ++i) most = std::max(most, std::abs(x[i]));
  return most;
}

}  // namespace carnot::language
