// A stepper, and all that runs by it, behind the function pointers of flow_calls.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "carnot/flow/automatic_flow.h"
#include "carnot/flow/flow_calls.h"
#include "carnot/flow/monitor.h"
#include "carnot/flow/tangent_flow.h"
#include "carnot/flow/trajectory.h"
#include "carnot/flow/winding.h"
#include "carnot/step/runge_kutta.h"
#include "carnot/system/erased_system.h"
#include "carnot/system/system_calls.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

namespace kernel {

template <int n>
Winding<n> winding_of(std::span<const double> periods) {
  std::array<double, n> all{};
  for (int i = 0; i < n; ++i) all[i] = periods[i];
  return Winding<n>(all);
}

// The `method` of a kernel that knows its system. A stepper is made of it for every run.
template <class Stepper_>
struct Direct {
  using Stepper = Stepper_;
  using System = typename Stepper::System;
  static constexpr int n = System::kDof;

  std::decay_t<decltype(std::declval<const Stepper&>().tableau())> tableau;
  Winding<n> winding;

  [[nodiscard]] const System& system(const void* opaque) const {
    return SystemOnBranch<System>::from(opaque).system;
  }
  [[nodiscard]] auto branch(const void* opaque) const {
    return SystemOnBranch<System>::from(opaque).branch;
  }
};

// The `method` of a kernel for any system of n coordinates.
template <class Stepper_>
struct Erased {
  using Stepper = Stepper_;
  using System = typename Stepper::System;
  static constexpr int n = System::kDof;

  std::decay_t<decltype(std::declval<const Stepper&>().tableau())> tableau;
  Winding<n> winding;
  const SystemFunctions* functions;

  [[nodiscard]] System system(const void* opaque) const { return {opaque, *functions}; }
  [[nodiscard]] auto branch(const void* opaque) const { return system(opaque).branch(); }
};

template <class M>
typename M::Stepper stepper_of(const M& method,
                               const typename M::System& system,
                               const void* opaque) {
  typename M::Stepper stepper(system, method.tableau);
  stepper.start_on(method.branch(opaque));
  return stepper;
}

template <int n>
State<double, n> load(const double* z) {
  State<double, n> state{Vector<double, 2 * n>(z), {}};
  std::fill_n(state.compensation.data(), 2 * n, 0.0);
  return state;
}

template <class M>
FlowReport flow(const void* opaque, const void* data, const StepPlan& plan, double* z) {
  constexpr int n = M::n;
  const M& method = *static_cast<const M*>(data);
  const auto& system = method.system(opaque);
  auto stepper = stepper_of(method, system, opaque);
  auto state = load<n>(z);
  auto winding = method.winding;
  const FlowReport report = carnot::flow(stepper, plan, state, [&](long, const auto&, auto& node) {
    winding.fold(node);
    return true;
  });
  store(winding.unfolded(state).value, z);
  return report;
}

template <class M>
FlowReport tangent_flow(const void* opaque,
                        const void* data,
                        const StepPlan& plan,
                        double* z,
                        double* m,
                        double* nodes) {
  constexpr int kSize = 2 * M::n;
  using Square = Matrix<double, kSize, kSize>;
  const M& method = *static_cast<const M*>(data);
  const auto& system = method.system(opaque);
  auto stepper = stepper_of(method, system, opaque);
  auto state = load<M::n>(z);
  auto winding = method.winding;
  winding.fold(state);
  Compensated<Square> tangent{identity<kSize, double>(), filled<kSize, kSize>(0.0)};
  const auto store_tangent = [&](double* to) {
    for (int r = 0; r < kSize; ++r) {
      for (int c = 0; c < kSize; ++c) to[r * kSize + c] = tangent.value(r, c);
    }
  };
  const auto observe = [&](long i, const auto&, auto& node) {
    winding.fold(node);
    if (nodes != nullptr) store(winding.unfolded(node).value, nodes + i * kSize);
    if (nodes != nullptr) store_tangent(m + i * kSize * kSize);
    return true;
  };
  const TangentOf of = nodes == nullptr ? TangentOf::kFlow : TangentOf::kStep;
  const FlowReport report = carnot::tangent_flow(stepper, plan, state, tangent, observe, of);
  store(winding.unfolded(state).value, z);
  if (nodes == nullptr) store_tangent(m);
  return report;
}

template <class M>
FlowSummary monitored_flow(const void* opaque,
                           const void* data,
                           const StepPlan& plan,
                           double* z,
                           const MonitorOptions& options) {
  constexpr long kProgressEvery = 256;
  using Stepper = typename M::Stepper;
  const M& method = *static_cast<const M*>(data);
  const auto& system = method.system(opaque);
  auto stepper = stepper_of(method, system, opaque);
  auto state = load<M::n>(z);
  Monitor<Stepper> monitor(system, plan.start, stepper, state);
  Recorder<Stepper> recorder(
      plan,
      options.times.empty() ? sample_times(plan, options.samples) : options.times,
      stepper,
      state);
  auto winding = method.winding;
  FlowSummary summary;
  summary.report = carnot::flow(stepper, plan, state, [&](long i, const Stepper& step, auto& node) {
    monitor(plan.time(i + 1), step, node);
    if (!std::isfinite(monitor.energy_drift())) return false;
    recorder(i, step, winding.unfolded(node), monitor.work());
    winding.fold(node);
    if (!options.progress || i % kProgressEvery != 0) return true;
    return options.progress(static_cast<double>(i) / static_cast<double>(plan.count));
  });
  store(winding.unfolded(state).value, z);
  if (!std::isfinite(monitor.energy_drift())) {
    summary.report.status = FlowStatus::kStepFailed;
    summary.report.last.status = StepStatus::kRateFailed;
    summary.report.last.rate = RateStatus::kNotFinite;
  }
  summary.action = monitor.action();
  summary.length = monitor.length();
  summary.work = monitor.work();
  summary.energy_drift = monitor.energy_drift();
  summary.energy_balance = monitor.energy_balance();
  summary.constraint_error = monitor.constraint_error();
  summary.holonomic_error = monitor.holonomic_error();
  summary.trajectory = recorder.take();
  return summary;
}

template <class M>
AutomaticFlow automatic_flow(const void* opaque,
                             const void* data,
                             double start,
                             double duration,
                             double tolerance,
                             double* z) {
  const M& method = *static_cast<const M*>(data);
  const auto& system = method.system(opaque);
  const auto stepper = stepper_of(method, system, opaque);
  auto state = load<M::n>(z);
  const AutomaticFlow result =
      carnot::automatic_flow(stepper, start, duration, tolerance, state, method.winding);
  store(state.value, z);
  return result;
}

// The calls of any stepper.
template <class M>
Kernel kernel_of(M method) {
  Kernel kernel;
  kernel.calls.flow = flow<M>;
  kernel.calls.tangent_flow = tangent_flow<M>;
  kernel.calls.monitored_flow = monitored_flow<M>;
  kernel.method = std::make_shared<const M>(std::move(method));
  return kernel;
}

inline bool is_gauss(const Tableau<double>& tableau) {
  return tableau.coupling == Coupling::kFull && !tableau.partitioned &&
         tableau.order == 2 * tableau.stages();
}

// Stages of one pack. Methods with as many stages, or fewer, run in a kernel that keeps them side
// by side: the default method, gauss16, fills it. One stage alone would waste the others. All
// stages move the step there, so that none may have the weight zero.
inline constexpr int kRowStages = 8;

inline bool fits_in_rows(const Tableau<double>& tableau) {
  return tableau.coupling == Coupling::kFull && !tableau.partitioned && tableau.stages() > 1 &&
         tableau.stages() <= kRowStages && tableau.all_weighted();
}

template <class M>
void add_automatic_flow(const Tableau<double>& tableau, Kernel& kernel) {
  if (is_gauss(tableau) && tableau.stages() >= kLeastSampled) {
    kernel.calls.automatic_flow = automatic_flow<M>;
  }
}

}  // namespace kernel

// The kernel of a Runge-Kutta method for systems of n coordinates that are reached through
// `functions`, which must outlive it.
template <int n>
Kernel make_erased_kernel(const Tableau<double>& tableau,
                          std::span<const double> periods,
                          const SystemFunctions& functions) {
  using namespace kernel;
  using System = ErasedSystem<n>;
  Kernel kernel;
  if (fits_in_rows(tableau)) {
    using M = Erased<RungeKutta<System, kRowStages>>;
    kernel = kernel_of(M{fixed_stages<kRowStages>(tableau), winding_of<n>(periods), &functions});
    add_automatic_flow<M>(tableau, kernel);
    kernel.fills_packs = functions.packs && tableau.stages() == kRowStages;
    return kernel;
  }
  using M = Erased<RungeKutta<System>>;
  kernel = kernel_of(M{tableau, winding_of<n>(periods), &functions});
  add_automatic_flow<M>(tableau, kernel);
  return kernel;
}

}  // namespace carnot
