// The midpoint transcription behind the function pointers of segment.h.
#pragma once

#include <type_traits>

#include "carnot/admissible_velocities.h"
#include "carnot/index_one_system.h"
#include "carnot/midpoint_transcription.h"
#include "carnot/optimal_control.h"
#include "carnot/velocity_constraints.h"

namespace carnot::segment_calls {

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
struct IsTranscribed<VelocityConstraints<Scene>> : std::bool_constant<!HasHolonomic<Scene>> {};
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
  if (jacobian == nullptr) {
    MidpointTerms<double, n, k> out;
    if (!midpoint_terms(system, qm, v, out)) return false;
    for (int i = 0; i < n; ++i) terms[i] = out.r[i];
    for (int i = 0; i < k; ++i) terms[n + i] = out.c[i];
    terms[n + k] = out.potential;
    return true;
  }
  using J = Jet<double, 2 * n>;
  Vector<J, n> qj;
  Vector<J, n> vj;
  for (int i = 0; i < n; ++i) {
    qj[i] = J(qm[i], i);
    vj[i] = J(v[i], n + i);
  }
  MidpointTerms<J, n, k> out;
  if (!midpoint_terms(system, qj, vj, out)) return false;
  const auto store = [&](int row, const J& x) {
    terms[row] = x.a;
    view<2 * n>(jacobian + row * 2 * n) = x.v;
  };
  for (int i = 0; i < n; ++i) store(i, out.r[i]);
  for (int i = 0; i < k; ++i) store(n + i, out.c[i]);
  store(n + k, out.potential);
  return true;
}

template <class B>
void discrete_lagrangian(
    const void* opaque, double h, const double* x_in, double* gradient_out, double* hessian) {
  constexpr int m = 2 * B::n + kTranscribed<B>;
  const auto& system = transcription(B::from(opaque).system);
  const Vector<double, m> x = view<m>(x_in);
  Vector<double, m> slope;
  Matrix<double, m, m> second;
  carnot::discrete_lagrangian(system, h, x, slope, hessian != nullptr ? &second : nullptr);
  view<m>(gradient_out) = slope;
  if (hessian != nullptr) view<m * m>(hessian) = view<m * m>(second.data());
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

}  // namespace carnot::segment_calls
