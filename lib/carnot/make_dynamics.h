// Dynamics of a scene: the templates of the core behind the function pointers of dynamics.h.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "carnot/dynamics.h"
#include "carnot/flow/automatic_flow.h"
#include "carnot/flow/batch.h"
#include "carnot/flow/monitor.h"
#include "carnot/flow/tangent_flow.h"
#include "carnot/flow/trajectory.h"
#include "carnot/flow/winding.h"
#include "carnot/step/gauss.h"
#include "carnot/step/rattle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/system/system_of.h"
#include "carnot/tableau/methods.h"
#include "carnot/transcription/transcription_calls.h"

namespace carnot {

namespace dynamics_calls {

// What a Dynamics points to. A stepper is made of it for every run.
template <class Stepper_>
struct Bound {
  using Stepper = Stepper_;
  using System = typename Stepper::System;
  static constexpr int n = System::kDof;
  static constexpr int m = System::kAlgebraic;
  static constexpr int k = System::kMultipliers;

  System system;
  std::decay_t<decltype(std::declval<const Stepper&>().tableau())> tableau;
  Vector<double, m> branch = Vector<double, m>::Zero();
  Winding<n> winding = {};

  [[nodiscard]] Stepper stepper() const {
    Stepper step(system, tableau);
    step.start_on(branch);
    return step;
  }
  static const Bound& from(const void* opaque) { return *static_cast<const Bound*>(opaque); }
};

template <class B>
State<double, B::n> load(const double* z) {
  return {view<2 * B::n>(z), Vector<double, 2 * B::n>::Zero()};
}

template <class B>
FlowReport flow(const void* opaque, const StepPlan& plan, double* z) {
  auto stepper = B::from(opaque).stepper();
  auto state = load<B>(z);
  auto winding = B::from(opaque).winding;
  const FlowReport report = carnot::flow(stepper, plan, state, [&](long, const auto&, auto& node) {
    winding.fold(node);
    return true;
  });
  view<2 * B::n>(z) = winding.unfolded(state).value;
  return report;
}

template <class B>
FlowReport tangent_flow(const void* opaque, const StepPlan& plan, double* z, double* m) {
  using Square = Matrix<double, 2 * B::n, 2 * B::n>;
  auto stepper = B::from(opaque).stepper();
  auto state = load<B>(z);
  Compensated<Square> tangent{Square::Identity(), Square::Zero()};
  const FlowReport report = carnot::tangent_flow(
      stepper, plan, state, tangent, [](long, const auto&, const auto&) { return true; });
  view<2 * B::n>(z) = state.value;
  using RowMajor = Eigen::Matrix<double, 2 * B::n, 2 * B::n, Eigen::RowMajor>;
  Eigen::Map<RowMajor> out(m);
  out = tangent.value;
  return report;
}

template <class B>
AutomaticFlow automatic_flow(
    const void* opaque, double start, double duration, double tolerance, double* z) {
  const auto stepper = B::from(opaque).stepper();
  auto state = load<B>(z);
  const AutomaticFlow result = carnot::automatic_flow(stepper, start, duration, tolerance, state);
  view<2 * B::n>(z) = state.value;
  return result;
}

template <class B>
BatchReport adaptive_batch(const void* opaque,
                           double start,
                           double duration,
                           double tolerance,
                           int count,
                           double* z,
                           int threads) {
  return carnot::adaptive_batch(
      B::from(opaque).system, start, duration, tolerance, count, z, threads);
}

template <class B>
FlowSummary monitored_flow(const void* opaque,
                           const StepPlan& plan,
                           double* z,
                           const MonitorOptions& options) {
  constexpr long kProgressEvery = 256;
  using Stepper = typename B::Stepper;
  const B& bound = B::from(opaque);
  auto stepper = bound.stepper();
  auto state = load<B>(z);
  Monitor<Stepper> monitor(bound.system, plan.start, stepper, state);
  Recorder<Stepper> recorder(
      plan,
      options.times.empty() ? sample_times(plan, options.samples) : options.times,
      stepper,
      state);
  auto winding = bound.winding;
  FlowSummary summary;
  summary.report = carnot::flow(stepper, plan, state, [&](long i, const Stepper& step, auto& node) {
    monitor(plan.time(i + 1), step, node);
    if (!std::isfinite(monitor.energy_drift())) return false;
    recorder(i, step, winding.unfolded(node));
    winding.fold(node);
    if (!options.progress || i % kProgressEvery != 0) return true;
    return options.progress(static_cast<double>(i) / static_cast<double>(plan.count));
  });
  view<2 * B::n>(z) = winding.unfolded(state).value;
  if (!std::isfinite(monitor.energy_drift())) {
    summary.report.status = FlowStatus::kStepFailed;
    summary.report.last.status = StepStatus::kRateFailed;
    summary.report.last.rate = RateStatus::kNotFinite;
  }
  summary.action = monitor.action();
  summary.length = monitor.length();
  summary.energy_drift = monitor.energy_drift();
  summary.energy_balance = monitor.energy_balance();
  summary.constraint_error = monitor.constraint_error();
  summary.holonomic_error = monitor.holonomic_error();
  summary.trajectory = recorder.trajectory();
  return summary;
}

template <class B>
PointValues evaluate(const void* opaque,
                     double t,
                     const double* q_in,
                     const double* p_in,
                     double* q_dot,
                     double* lambda_out) {
  const B& bound = B::from(opaque);
  const Vector<double, B::n> q = view<B::n>(q_in);
  const Vector<double, B::n> p = view<B::n>(p_in);
  Vector<double, B::m> y = bound.branch;
  Vector<double, B::k> lambda = Vector<double, B::k>::Zero();
  Rate<double, B::n> rate;
  PointValues values;
  values.status = bound.system.rate(t, q, p, y, rate);
  if constexpr (HasRegularity<typename B::System>) {
    values.regularity = bound.system.regularity(t, q, p, y);
  }
  if (values.status != RateStatus::kOk) return values;
  values.status = bound.system.multipliers(t, q, p, y, lambda);
  values.hamiltonian = bound.system.hamiltonian(t, q, p, y);
  view<B::n>(q_dot) = rate.q_dot;
  view<B::k>(lambda_out) = lambda;
  return values;
}

template <class B>
double momentum(const void* opaque,
                double t,
                const double* q_in,
                double* q_dot,
                const double* lambda_in,
                double* p_out) {
  const Vector<double, B::n> q = view<B::n>(q_in);
  Vector<double, B::n> v = view<B::n>(q_dot);
  Vector<double, B::n> p;
  const Vector<double, B::k> lambda = view<B::k>(lambda_in);
  const double violated = B::from(opaque).system.admissible_momentum(t, q, v, lambda, p);
  view<B::n>(q_dot) = v;
  view<B::n>(p_out) = p;
  return violated;
}

// max |h(q)|, and that of Dh q' over |q'|.
template <class B>
HolonomicResiduals holonomic_residuals(const void* opaque, double t, const double* z) {
  const auto& system = B::from(opaque).system;
  const Vector<double, B::n> q = view<B::n>(z);
  Vector<double, B::m> y = B::from(opaque).branch;
  Vector<double, 2 * B::n> rate;
  HolonomicResiduals residuals;
  residuals.position = holonomic_residual(system.scene(), q);
  if (phase_rate(system, t, Vector<double, 2 * B::n>(view<2 * B::n>(z)), y, rate) ==
      RateStatus::kOk) {
    const Vector<double, B::n> v = rate.template head<B::n>();
    const double size = v.cwiseAbs().maxCoeff();
    residuals.velocity = size > 0 ? hidden_residual(system.scene(), q, v) / size : 0;
  }
  return residuals;
}

template <class B>
bool project_on_manifold(const void* opaque, double t, double* z) {
  const auto& system = B::from(opaque).system;
  Vector<double, B::n> q = view<B::n>(z);
  Vector<double, B::n> p = view<B::n>(z + B::n);
  if (!project_configuration(system.scene(), q)) return false;
  if (project_momentum(system, t, q, p) != RateStatus::kOk) return false;
  view<B::n>(z) = q;
  view<B::n>(z + B::n) = p;
  return true;
}

template <class B>
bool tangent_projector(const void* opaque, double t, const double* z, double* projector) {
  Matrix<double, 2 * B::n, 2 * B::n> p;
  const Vector<double, 2 * B::n> at = view<2 * B::n>(z);
  if (!manifold_projector(B::from(opaque).system, t, at, p)) return false;
  view<4 * B::n * B::n>(projector) = view<4 * B::n * B::n>(p.data());
  return true;
}

template <class B>
double chart(const void* opaque, const double* q) {
  return B::from(opaque).system.scene().chart(Vector<double, B::n>(view<B::n>(q)));
}

template <class B>
std::shared_ptr<const void> branch(
    const void* opaque, double t, const double* q, const double* p, const double* lambda) {
  const B& bound = B::from(opaque);
  auto other = std::make_shared<B>(bound);
  const RateStatus status = bound.system.branch(t,
                                                Vector<double, B::n>(view<B::n>(q)),
                                                Vector<double, B::n>(view<B::n>(p)),
                                                Vector<double, B::k>(view<B::k>(lambda)),
                                                other->branch);
  if (status != RateStatus::kOk) return nullptr;
  return other;
}

template <class B, class Scene>
Dynamics bind(const Scene& scene, const Method& method, B bound) {
  using System = typename B::System;
  Dynamics dynamics;
  dynamics.dof = B::n;
  dynamics.multipliers = B::k;
  dynamics.autonomous = System::kAutonomous;
  dynamics.method = method.name;
  dynamics.order = method.order;
  dynamics.symplectic = method.symplectic;
  dynamics.info = describe_scene(scene);
  std::array<double, B::n> periods{};
  for (int i = 0; i < B::n; ++i) periods[i] = dynamics.info.configuration[i].period;
  bound.winding = Winding<B::n>(periods);
  dynamics.system = std::make_shared<const B>(std::move(bound));
  dynamics.calls.flow = flow<B>;
  dynamics.calls.tangent_flow = tangent_flow<B>;
  dynamics.calls.monitored_flow = monitored_flow<B>;
  dynamics.calls.evaluate = evaluate<B>;
  dynamics.calls.momentum = momentum<B>;
  if constexpr (HasChart<Scene>) dynamics.calls.chart = chart<B>;
  if constexpr (HasBranches<System>) dynamics.calls.branch = branch<B>;
  if constexpr (HasHolonomic<Scene>) {
    dynamics.holonomic = Scene::kHolonomic;
    dynamics.forced = method.family == kRattleFamily ? Scene::kHolonomic : 0;
    dynamics.calls.holonomic_residuals = holonomic_residuals<B>;
    dynamics.calls.project_on_manifold = project_on_manifold<B>;
    dynamics.calls.tangent_projector = tangent_projector<B>;
  }
  if constexpr (IsTranscribed<System>::value) {
    if (dynamics.forced > 0) return dynamics;
    dynamics.transcribed = kTranscribed<B>;
    dynamics.calls.midpoint = midpoint<B>;
    dynamics.calls.midpoint_multipliers = midpoint_multipliers<B>;
    dynamics.calls.discrete_lagrangian = discrete_lagrangian<B>;
  }
  return dynamics;
}

template <class Scene>
Dynamics bind_rattle(const Scene& scene, const Method& method) {
  auto system = make_system(scene);
  using B = Bound<Rattle<decltype(system)>>;
  return bind(scene, method, B{std::move(system), make_tableau(method)});
}

template <class Scene>
Dynamics bind_runge_kutta(const Scene& scene, const Method& method) {
  auto system = make_system(scene);
  using System = decltype(system);
  const Tableau<double> tableau = make_tableau(method);
  // The default method with all that the compiler can do for it; one kernel for the others.
  constexpr int kFixed = 8;
  if (tableau.coupling == Coupling::kFull && !tableau.partitioned && tableau.stages() == kFixed) {
    using Stepper = RungeKutta<System, kFixed>;
    using B = Bound<Stepper>;
    Dynamics dynamics = bind(scene, method, B{std::move(system), fixed_stages<kFixed>(tableau)});
    dynamics.calls.automatic_flow = automatic_flow<B>;
    if constexpr (PacksRates<System>) dynamics.calls.adaptive_batch = adaptive_batch<B>;
    return dynamics;
  }
  using B = Bound<RungeKutta<System>>;
  Dynamics dynamics = bind(scene, method, B{std::move(system), tableau});
  const bool gauss = tableau.coupling == Coupling::kFull && !tableau.partitioned &&
                     tableau.order == 2 * tableau.stages();
  if (gauss && tableau.stages() >= kLeastSampled) {
    dynamics.calls.automatic_flow = automatic_flow<B>;
  }
  return dynamics;
}

}  // namespace dynamics_calls

// Whether holonomic constraints of the scene need RATTLE.
template <class Scene>
inline constexpr bool kNeedsRattle = HasHolonomic<Scene> && !IsProduct<Scene>;

// Whether `method` can integrate the scene.
template <class Scene>
bool suits(const Method& method) {
  if (!HasHolonomic<Scene> || method.family == kRattleFamily) return true;
  const bool keeps_quadratic = method.family == kGaussFamily || method.family == kComposedFamily;
  return IsProduct<Scene> && keeps_quadratic;
}

// gauss16, or rattle where it is needed.
template <class Scene>
constexpr std::string_view default_method() {
  return kNeedsRattle<Scene> ? "rattle" : "gauss16";
}

// A Dynamics of the scene with a method of methods.h. Throws std::invalid_argument when a parameter
// of the scene is out of its range, or there is no such method for it.
template <class Scene>
Dynamics make_dynamics(const Scene& scene, std::string_view method_name = default_method<Scene>()) {
  using namespace dynamics_calls;
  validate(scene);
  const Method* const method = find_method(method_name);
  if (method == nullptr || !suits<Scene>(*method)) {
    throw std::invalid_argument("method " + std::string(method_name) +
                                (method == nullptr ? ": there is none of that name"
                                                   : ": it does not keep the holonomic "
                                                     "constraints of this scene"));
  }
  if constexpr (kNeedsRattle<Scene>) {
    return bind_rattle(scene, *method);
  } else if constexpr (HasHolonomic<Scene>) {
    return method->family == kRattleFamily ? bind_rattle(scene, *method)
                                           : bind_runge_kutta(scene, *method);
  } else {
    return bind_runge_kutta(scene, *method);
  }
}

}  // namespace carnot
