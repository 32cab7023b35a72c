// A scene behind the function pointers of transcription_functions.h.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <type_traits>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/pack.h"
#include "carnot/numerics/second_jet.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/optimal_control.h"
#include "carnot/system/velocity_constraints.h"
#include "carnot/transcription/admissible_velocities.h"
#include "carnot/transcription/transcription_functions.h"

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

// run(the system, with velocities in these units). Only a gauge has units, see
// transcription_functions.h.
template <class Scene, class Run>
void with_units(const VelocityConstraints<Scene>& system, const GaugeUnits&, const Run& run) {
  run(system);
}
template <class Scene, class Run>
void with_units(const OptimalControl<Scene>& system, const GaugeUnits& units, const Run& run) {
  AdmissibleVelocities<Scene> velocities{system.scene()};
  for (int j = 0; units.q != nullptr && j < Scene::kDof; ++j) {
    velocities.per_unit[j] = 1 / units.q[j];
  }
  velocities.weight = units.weight;
  run(VelocityConstraints<AdmissibleVelocities<Scene>>(velocities));
}

template <class System>
struct IsTranscribed : std::false_type {};
template <class Scene>
struct IsTranscribed<VelocityConstraints<Scene>>
    : std::bool_constant<!HasHolonomic<Scene> || IsProduct<Scene>> {};
template <class Scene>
struct IsTranscribed<OptimalControl<Scene>> : std::bool_constant<OptimalControl<Scene>::kMetric> {};

// A scene with dependent rows G, which are a projector: it writes P = I - G, and its Lagrangian.
template <class S>
concept HasGauge = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.gauge(q) } -> std::convertible_to<Matrix<double, S::kMultipliers, S::kMultipliers>>;
};

// Writes a number, or a pack of them, and moves on.
inline void write_number(double x, double*& to) { *to++ = x; }
template <int W, class Lane>
void write_number(const Pack<W, Lane>& x, double*& to) {
  x.store(to);
  to += W;
}

// The functions of TranscriptionFunctions for B, a SystemOnBranch. Rows of plain numbers are
// filled.
template <class Scene, class T>
void write_entries(const VelocityConstraints<Scene>& system,
                   const Vector<T, Scene::kDof>& q,
                   double* out) {
  static_assert(Scene::kDof < kLongestRow);
  const auto write = [&](const T& x) {
    write_number(value_of(x), out);
    if constexpr (kIsJet<T>) {
      for (int d = 0; d < Scene::kDof; ++d) write_number(x.v[d], out);
      if constexpr (std::is_same_v<typename T::Scalar, double>) {
        for (int d = Scene::kDof + 1; d < row_length(Scene::kDof); ++d) *out++ = 0;
      }
    }
  };
  if constexpr (HasConstantMass<Scene>) {
    // No matrix of Jets that are zero: starts of a vehicle relax in 0.9 of the
    // time for it.
    const auto mass =
        system.scene().mass(Vector<double, Scene::kDof>(Vector<double, Scene::kDof>::Zero()));
    for (int i = 0; i < Scene::kDof; ++i) {
      for (int j = 0; j <= i; ++j) write(T(mass(i, j)));
    }
  } else {
    const Matrix<T, Scene::kDof, Scene::kDof> mass = system.scene().mass(q);
    for (int i = 0; i < Scene::kDof; ++i) {
      for (int j = 0; j <= i; ++j) write(mass(i, j));
    }
  }
  if constexpr (Scene::kMultipliers > 0) {
    const Matrix<T, Scene::kMultipliers, Scene::kDof> rows = system.scene().constraints(q);
    for (int i = 0; i < Scene::kMultipliers; ++i) {
      for (int j = 0; j < Scene::kDof; ++j) write(rows(i, j));
    }
  }
  write(system.potential(q));
}

template <class B>
void transcription_entries(
    const void* opaque, const double* q, const GaugeUnits& units, bool slopes, double* out) {
  const Vector<double, B::n> at = vector_at<B::n>(q);
  with_units(B::from(opaque).system, units, [&](const auto& system) {
    if (slopes) {
      write_entries(system, seeded(at), out);
    } else {
      write_entries(system, at, out);
    }
  });
}

template <class B>
void transcription_packed_entries(
    const void* opaque, const double* q, const GaugeUnits& units, bool slopes, double* out) {
  using P = Pack<kTranscriptionLanes>;
  Vector<P, B::n> at;
  for (int j = 0; j < B::n; ++j) at[j] = P::load(q + j * kTranscriptionLanes);
  with_units(B::from(opaque).system, units, [&](const auto& system) {
    if (slopes) {
      write_entries(system, seeded(at), out);
    } else {
      write_entries(system, at, out);
    }
  });
}

// Calls add(entry, weight) with what of l at x has second derivatives. l is linear in M, G and V,
// so that no product of Jets is formed. v and lambda are numbers N.
template <class Scene, class T, class N, class Add>
void add_lagrangian(const VelocityConstraints<Scene>& system,
                    const Vector<T, Scene::kDof>& x,
                    const N* v,
                    const N* lambda,
                    const Add& add) {
  constexpr int n = Scene::kDof;
  constexpr int k = Scene::kMultipliers;
  const auto& scene = system.scene();
  if constexpr (HasGauge<Scene>) {
    Vector<T, n> velocity;
    Vector<T, n> multipliers;
    for (int i = 0; i < n; ++i) {
      velocity[i] = T(typename T::Scalar(v[i]));
      multipliers[i] = T(typename T::Scalar(lambda[i]));
    }
    add(scene.gauged_lagrangian(x, velocity, multipliers), N(1));
  } else {
    if constexpr (HasPotential<Scene>) add(system.potential(x), N(-1));
    if constexpr (!HasConstantMass<Scene>) {
      const Matrix<T, n, n> mass = scene.mass(x);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) add(mass(i, j), N(j < i ? 1 : 0.5) * v[i] * v[j]);
      }
    }
    if constexpr (k > 0) {
      const Matrix<T, k, n> rows = scene.constraints(x);
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j < n; ++j) add(rows(i, j), -lambda[i] * v[j]);
      }
    }
  }
}

// l_qq, n x n, at a point or, with packs N for numbers, at as many side by side.
template <class Scene, class N>
std::array<N, Scene::kDof * Scene::kDof> lagrangian_hessian(
    const VelocityConstraints<Scene>& system, const N* q, const N* v, const N* lambda) {
  constexpr int n = Scene::kDof;
  using T = SecondJet<N, n>;
  Vector<T, n> x;
  for (int j = 0; j < n; ++j) x[j] = T(q[j], j);
  std::array<N, T::kPairs> sum{};
  add_lagrangian(system, x, v, lambda, [&](const T& entry, const N& weight) {
    for (int pair = 0; pair < T::kPairs; ++pair) sum[pair] += weight * entry.w[pair];
  });
  std::array<N, n * n> l_qq;
  for (int i = 0, pair = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j, ++pair) l_qq[i * n + j] = l_qq[j * n + i] = sum[pair];
  }
  return l_qq;
}

template <class B>
void transcription_hessian(const void* opaque,
                           const double* q,
                           const double* v,
                           const double* lambda,
                           const GaugeUnits& units,
                           double* l_qq) {
  with_units(B::from(opaque).system, units, [&](const auto& system) {
    const auto entries = lagrangian_hessian(system, q, v, lambda);
    std::copy(entries.begin(), entries.end(), l_qq);
  });
}

template <class B>
void transcription_packed_hessian(const void* opaque,
                                  const double* q,
                                  const double* v,
                                  const double* lambda,
                                  const GaugeUnits& units,
                                  double* l_qq) {
  using P = Pack<kTranscriptionLanes>;
  const auto packs = [](const double* from, auto& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = P::load(from + i * kTranscriptionLanes);
  };
  std::array<P, B::n> at;
  std::array<P, B::n> velocity;
  packs(q, at);
  packs(v, velocity);
  with_units(B::from(opaque).system, units, [&](const auto& system) {
    using Scene = std::decay_t<decltype(system.scene())>;
    std::array<P, Scene::kMultipliers> multipliers;
    packs(lambda, multipliers);
    const auto entries = lagrangian_hessian(system, at.data(), velocity.data(), multipliers.data());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      entries[i].store(l_qq + i * kTranscriptionLanes);
    }
  });
}

template <class B>
const TranscriptionFunctions& transcription_of() {
  using Scene = std::decay_t<decltype(transcription(B::from(nullptr).system).scene())>;
  static constexpr TranscriptionFunctions kFunctions = [] {
    TranscriptionFunctions f{B::n,
                             Scene::kMultipliers,
                             HasGauge<Scene>,
                             transcription_entries<B>,
                             transcription_hessian<B>};
    if constexpr (B::System::kPacks) {
      f.packed_entries = transcription_packed_entries<B>;
      f.packed_hessian = transcription_packed_hessian<B>;
    }
    return f;
  }();
  return kFunctions;
}

}  // namespace carnot::dynamics_calls
