// The functions of a system behind the pointers of system_functions.h: all that a scene compiles of
// its own for the kernels.
#pragma once

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>

#include "carnot/numerics/gradient.h"
#include "carnot/system/measures.h"
#include "carnot/system/packed_iteration.h"
#include "carnot/system/packed_rate.h"
#include "carnot/system/phase_space.h"
#include "carnot/system/system_functions.h"

namespace carnot {

// A system, and the solution y of H_y = 0 that its runs begin with; zero leaves the choice to the
// system. This is what the pointers point to.
template <class System_>
struct SystemOnBranch {
  using System = System_;
  static constexpr int n = System::kDof;
  static constexpr int m = System::kAlgebraic;
  static constexpr int k = System::kMultipliers;

  System system;
  Vector<double, m> branch = Vector<double, m>::Zero();

  static const SystemOnBranch& from(const void* opaque) {
    return *static_cast<const SystemOnBranch*>(opaque);
  }
};

// Whether the kernels have room for its algebraic variables.
template <class System>
inline constexpr bool kFitsKernel =
    System::kAlgebraic <= kMostAlgebraic* System::kDof&& System::kMultipliers <=
    kMostAlgebraic* System::kDof;

namespace system_calls {

template <class System>
const System& system_of(const void* opaque) {
  return SystemOnBranch<System>::from(opaque).system;
}

template <class System>
RateStatus rate(const void* opaque, double t, const double* z, double* y, double* z_dot) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  const Vector<double, n> q = vector_at<n>(z);
  const Vector<double, n> p = vector_at<n>(z + n);
  Vector<double, m> algebraic = vector_at<m>(y);
  Rate<double, n> out;
  const RateStatus status = system_of<System>(opaque).rate(t, q, p, algebraic, out);
  if (status != RateStatus::kOk) return status;
  store(algebraic, y);
  store(out.q_dot, z_dot);
  store(out.p_dot, z_dot + n);
  return status;
}

template <class System>
RateStatus jacobian(const void* opaque, double t, const double* z, const double* y, double* out) {
  if constexpr (PacksRates<System>) {
    if (jacobian_in_pack(system_of<System>(opaque), t, z, out)) return RateStatus::kOk;
    // Why it fails, the rate itself can tell, but where it reaches farther than packs.
    std::array<double, 2 * System::kDof> z_dot;
    std::array<double, std::max(System::kAlgebraic, 1)> unused;
    const RateStatus status = rate<System>(opaque, t, z, unused.data(), z_dot.data());
    return status == RateStatus::kOk ? RateStatus::kFarAngle : status;
  } else {
    constexpr int kSize = 2 * System::kDof;
    constexpr int m = System::kAlgebraic;
    Matrix<double, kSize, kSize> a;
    const Vector<double, kSize> at = vector_at<kSize>(z);
    const Vector<double, m> algebraic = vector_at<m>(y);
    const RateStatus status = phase_jacobian(system_of<System>(opaque), t, at, algebraic, a);
    if (status == RateStatus::kOk) store(a, out);
    return status;
  }
}

// Side by side in a pack, or one after the other where the formulas branch on values or iterate.
template <class System>
bool rates(const void* opaque, const double* t, const double* z, double* y, double* z_dot) {
  if constexpr (PacksRates<System>) {
    return packed_rate<kErasedLanes>(system_of<System>(opaque), t, z, y, z_dot);
  } else {
    constexpr int kSize = 2 * System::kDof;
    constexpr int m = System::kAlgebraic;
    constexpr int s = kErasedLanes;
    std::array<double, kSize> point;
    std::array<double, kSize> out;
    std::array<double, std::max(m, 1)> algebraic;
    for (int l = 0; l < s; ++l) {
      for (int k = 0; k < kSize; ++k) point[k] = z[k * s + l];
      for (int k = 0; k < m; ++k) algebraic[k] = y[k * s + l];
      const RateStatus status =
          rate<System>(opaque, t[l], point.data(), algebraic.data(), out.data());
      if (status != RateStatus::kOk) return false;
      for (int k = 0; k < kSize; ++k) z_dot[k * s + l] = out[k];
      for (int k = 0; k < m; ++k) y[k * s + l] = algebraic[k];
    }
    return true;
  }
}

template <class System>
bool jacobians(
    const void* opaque, const double* t, const double* z, const double* weights, double* jacobian) {
  if constexpr (PacksRates<System>) {
    return packed_jacobian<kErasedLanes>(system_of<System>(opaque), t, z, weights, jacobian);
  } else {
    return false;
  }
}

template <class System>
StageReport iterate(const void* opaque,
                    const StageData& data,
                    const IterationLimits<double>& limits) {
  if constexpr (PacksRates<System>) {
    return packed_iteration<kErasedLanes>(system_of<System>(opaque), data, limits);
  } else {
    return iterate_with<2 * System::kDof, kErasedLanes>(
        [&](double* z_dot) {
          return rates<System>(opaque, data.time, data.stages, data.algebraic, z_dot);
        },
        data,
        limits);
  }
}

template <class System>
double hamiltonian(
    const void* opaque, double t, const double* q, const double* p, const double* y) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  return system_of<System>(opaque).hamiltonian(
      t, vector_at<n>(q), vector_at<n>(p), vector_at<m>(y));
}

template <class System>
RateStatus find_multipliers(
    const void* opaque, double t, const double* q, const double* p, const double* y, double* out) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  constexpr int k = System::kMultipliers;
  Vector<double, k> lambda = Vector<double, k>::Zero();
  const RateStatus status = system_of<System>(opaque).multipliers(
      t, vector_at<n>(q), vector_at<n>(p), vector_at<m>(y), lambda);
  store(lambda, out);
  return status;
}

template <class System>
void measure(const void* opaque,
             int count,
             const double* t,
             const double* weights,
             const double* z,
             const double* dq,
             const double* y,
             PointMeasures* out) {
  measure_points(system_of<System>(opaque), count, t, weights, z, dq, y, out);
}

template <class System>
NodeMeasures measure_node(const void* opaque, double t, const double* z, double* y) {
  constexpr int n = System::kDof;
  constexpr int m = System::kAlgebraic;
  Vector<double, m> algebraic = vector_at<m>(y);
  const NodeMeasures out = carnot::measure_node<System>(
      system_of<System>(opaque), t, vector_at<n>(z), vector_at<n>(z + n), algebraic);
  store(algebraic, y);
  return out;
}

template <class System>
void branch(const void* opaque, double* y) {
  store(SystemOnBranch<System>::from(opaque).branch, y);
}

}  // namespace system_calls

// The table of a System; its functions take a SystemOnBranch<System>.
template <class System>
const SystemFunctions& functions_of() {
  namespace calls = system_calls;
  static constexpr SystemFunctions kFunctions = {System::kDof,
                                                 System::kAlgebraic,
                                                 System::kMultipliers,
                                                 PacksRates<System>,
                                                 calls::rate<System>,
                                                 calls::jacobian<System>,
                                                 calls::rates<System>,
                                                 calls::jacobians<System>,
                                                 calls::iterate<System>,
                                                 calls::hamiltonian<System>,
                                                 calls::find_multipliers<System>,
                                                 calls::measure<System>,
                                                 calls::measure_node<System>,
                                                 calls::branch<System>};
  return kFunctions;
}

// The part of it that no kernel asks for: what is evaluated at a point.
template <class System>
const SystemFunctions& pointwise_functions_of() {
  namespace calls = system_calls;
  static constexpr SystemFunctions kFunctions = [] {
    SystemFunctions functions;
    functions.dof = System::kDof;
    functions.algebraic = System::kAlgebraic;
    functions.multipliers = System::kMultipliers;
    functions.rate = calls::rate<System>;
    functions.hamiltonian = calls::hamiltonian<System>;
    functions.find_multipliers = calls::find_multipliers<System>;
    functions.branch = calls::branch<System>;
    return functions;
  }();
  return kFunctions;
}

}  // namespace carnot
