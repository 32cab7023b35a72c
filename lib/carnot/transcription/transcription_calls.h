// The midpoint transcription behind the function pointers of dynamics.h.
#pragma once

#include <type_traits>

#include "carnot/numerics/gradient.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/optimal_control.h"
#include "carnot/system/velocity_constraints.h"
#include "carnot/transcription/admissible_velocities.h"
#include "carnot/transcription/midpoint_transcription.h"

namespace carnot::dynamics_calls {

// The velocity-constrained system that is transcribed: the system itself, or a control problem
// without its controls.
template <class Scene>
const VelocityConstraints<Scene>& transcription(const VelocityConstraints<Scene>& system) {
  return system;
}
template <class Scene>
auto transcription(const OptimalControl<Scene>& system) {
  return VelocityConstraints<AdmissibleVelocities<Scene>>({system.scene()});
}

template <class System>
struct IsTranscribed : std::false_type {};
template <class Scene>
struct IsTranscribed<VelocityConstraints<Scene>>
    : std::bool_constant<!HasHolonomic<Scene> || IsProduct<Scene>> {};
template <class Scene>
struct IsTranscribed<OptimalControl<Scene>> : std::bool_constant<OptimalControl<Scene>::kMetric> {};

// The number of constraints of the transcription.
template <class B>
inline constexpr int kTranscribed =
    std::decay_t<decltype(transcription(std::declval<const typename B::System&>()))>::kMultipliers;

template <class B>
bool midpoint(
    const void* opaque, const double* qm_in, const double* v_in, double* terms, double* jacobian) {
  constexpr int n = B::n;
  const auto& system = transcription(B::from(opaque).system);
  constexpr int k = kTranscribed<B>;
  const Vector<double, n> qm = view<n>(qm_in);
  const Vector<double, n> v = view<n>(v_in);
  // Terms sum_j a_j v_j; a row of the jacobian is a_q v, then a.
  const auto row_of = [&](const auto& matrix, int row, int first, int to) {
    double sum = 0;
    for (int j = first; j < n; ++j) sum += value_of(matrix(row, j)) * v[j];
    terms[to] = sum;
    if constexpr (kIsJet<typename std::decay_t<decltype(matrix)>::Scalar>) {
      double* const by_q = jacobian + to * 2 * n;
      double* const by_v = by_q + n;
      for (int i = 0; i < 2 * n; ++i) by_q[i] = 0;
      for (int j = first; j < n; ++j) {
        for (int i = 0; i < n; ++i) by_q[i] += v[j] * matrix(row, j).v[i];
        by_v[j] = matrix(row, j).a;
      }
    }
  };
  const auto write = [&](const auto& factors) {
    for (int i = 0; i < n; ++i) row_of(factors.root, i, i, i);
    for (int i = 0; i < k; ++i) row_of(factors.constraints, i, 0, n + i);
    terms[n + k] = value_of(factors.potential);
  };
  if (jacobian == nullptr) {
    MidpointFactors<double, n, k> factors;
    if (!midpoint_factors(system, qm, factors)) return false;
    write(factors);
    return true;
  }
  MidpointFactors<Jet<double, n>, n, k> factors;
  if (!midpoint_factors(system, seeded(qm), factors)) return false;
  write(factors);
  double* const last = jacobian + (n + k) * 2 * n;
  for (int i = 0; i < n; ++i) {
    last[i] = factors.potential.v[i];
    last[n + i] = 0;
  }
  return true;
}

template <class B>
void discrete_lagrangian(
    const void* opaque, double h, const double* x, double* gradient, double* hessian) {
  carnot::discrete_lagrangian(transcription(B::from(opaque).system), h, x, gradient, hessian);
}

// lambda of p = M v - G'lambda. With dependent rows that are a projector C, C lambda = -C p.
template <class B>
void midpoint_multipliers(const void* opaque, const double* q, const double* p, double* out) {
  constexpr int k = kTranscribed<B>;
  const Vector<double, B::n> at = view<B::n>(q);
  const auto& system = transcription(B::from(opaque).system);
  if constexpr (HasGauge<std::decay_t<decltype(system.scene())>>) {
    view<k>(out) = -(system.scene().constraints(at) * view<B::n>(p));
  } else {
    using System = std::decay_t<decltype(system)>;
    const Vector<double, B::n> momentum = view<B::n>(p);
    Vector<double, System::kAlgebraic> y = Vector<double, System::kAlgebraic>::Zero();
    Vector<double, k> lambda = Vector<double, k>::Zero();
    Rate<double, B::n> rate;
    if (system.rate(0.0, at, momentum, y, rate) == RateStatus::kOk) {
      (void)system.multipliers(0.0, at, momentum, y, lambda);
    }
    view<k>(out) = lambda;
  }
}

}  // namespace carnot::dynamics_calls
