// Where templates end: a scene and a method behind a handful of function pointers.
//
// Relaxation, shooting, NLopt and the apps are compiled once against this struct. All arguments are
// plain double pointers: q, p of length n, lambda and g of length k, z = (q, p) of length 2n. One
// indirect call per trajectory; inside it everything is inlined.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "carnot/audit.h"
#include "carnot/midpoint_transcription.h"
#include "carnot/scene_info.h"
#include "carnot/tangent_flow.h"
#include "carnot/trajectory.h"
#include "carnot/velocity_constraints.h"

namespace carnot {

// What a run of a Segment measured. `action` and what follows only from audited_flow().
struct FlowSummary {
  FlowReport report;
  double action = 0;
  double length = 0;
  double energy_drift = 0;
  double constraint_error = 0;
  Trajectory trajectory;

  [[nodiscard]] bool completed() const { return report.completed(); }
};

// Told the fraction done every now and then; returns false to stop.
using Progress = std::function<bool(double fraction)>;

struct AuditOptions {
  long samples = 0;           // equidistant times recorded in `trajectory`
  std::vector<double> times;  // recorded instead, where given; ascending, within the plan
  Progress progress;
};

// H, velocity and multipliers at one phase point.
struct PointValues {
  RateStatus status = RateStatus::kOk;
  double hamiltonian = std::numeric_limits<double>::quiet_NaN();
};

struct Segment {
  int dof = 0;
  int multipliers = 0;
  int order = 0;
  SceneInfo info;
  std::shared_ptr<const void> system;

  // Advances z in place; on failure z is that of time_reached. No allocation.
  [[nodiscard]] FlowReport flow(const StepPlan& plan, double* z) const {
    return calls.flow(system.get(), plan, z);
  }
  // The same, and m = dz(end)/dz(start), row-major 2n x 2n. No allocation.
  [[nodiscard]] FlowReport tangent_flow(const StepPlan& plan, double* z, double* m) const {
    return calls.tangent_flow(system.get(), plan, z, m);
  }
  // The same as flow(), measured and recorded.
  [[nodiscard]] FlowSummary audited_flow(const StepPlan& plan,
                                         double* z,
                                         const AuditOptions& options) const {
    return calls.audited_flow(system.get(), plan, z, options);
  }
  // H, q' and lambda at (t, q, p).
  PointValues evaluate(
      double t, const double* q, const double* p, double* q_dot, double* lambda) const {
    return calls.evaluate(system.get(), t, q, p, q_dot, lambda);
  }
  // p = M q' - G' lambda; the velocity is projected on ker G first. Returns |G q'| / |q'| before.
  double momentum(const double* q, double* q_dot, const double* lambda, double* p) const {
    return calls.momentum(system.get(), q, q_dot, lambda, p);
  }
  // Terms of one midpoint interval at (qm, v): r (n), c (k), V (1), stacked; jacobian row-major
  // (n + k + 1) x 2n with respect to (qm, v), may be null.
  [[nodiscard]] bool midpoint(const double* qm,
                              const double* v,
                              double* terms,
                              double* jacobian) const {
    return calls.midpoint(system.get(), qm, v, terms, jacobian);
  }
  // Gradient and Hessian of the discrete Lagrangian F_d with respect to x = (q0, q1, lambda), of
  // length 2n + k: the discrete momenta are p0 = -gradient[0..n), p1 = gradient[n..2n). The Hessian
  // (symmetric, (2n + k)^2) may be null.
  void discrete_lagrangian(double h, const double* x, double* gradient, double* hessian) const {
    calls.discrete_lagrangian(system.get(), h, x, gradient, hessian);
  }

  struct Calls {
    FlowReport (*flow)(const void*, const StepPlan&, double*);
    FlowReport (*tangent_flow)(const void*, const StepPlan&, double*, double*);
    FlowSummary (*audited_flow)(const void*, const StepPlan&, double*, const AuditOptions&);
    PointValues (*evaluate)(const void*, double, const double*, const double*, double*, double*);
    double (*momentum)(const void*, const double*, double*, const double*, double*);
    bool (*midpoint)(const void*, const double*, const double*, double*, double*);
    void (*discrete_lagrangian)(const void*, double, const double*, double*, double*);
  };
  Calls calls{};
};

namespace segment_calls {

template <class Step>
const typename Step::System& cast(const void* system) {
  return *static_cast<const typename Step::System*>(system);
}

template <class Step>
State<double, Step::kDof> load(const double* z) {
  return {view<Step::kSize>(z), Vector<double, Step::kSize>::Zero()};
}

template <class Step>
FlowReport flow(const void* system, const StepPlan& plan, double* z) {
  Step stepper(cast<Step>(system));
  auto state = load<Step>(z);
  const FlowReport report = carnot::flow(stepper, plan, state);
  view<Step::kSize>(z) = state.value;
  return report;
}

template <class Step>
FlowReport tangent_flow(const void* system, const StepPlan& plan, double* z, double* m) {
  using Square = Matrix<double, Step::kSize, Step::kSize>;
  Step stepper(cast<Step>(system));
  auto state = load<Step>(z);
  Compensated<Square> tangent{Square::Identity(), Square::Zero()};
  const FlowReport report = carnot::tangent_flow(
      stepper, plan, state, tangent, [](long, const Step&, const auto&) { return true; });
  view<Step::kSize>(z) = state.value;
  using RowMajor = Eigen::Matrix<double, Step::kSize, Step::kSize, Eigen::RowMajor>;
  Eigen::Map<RowMajor> out(m);
  out = tangent.value;
  return report;
}

template <class Step>
FlowSummary audited_flow(const void* opaque,
                         const StepPlan& plan,
                         double* z,
                         const AuditOptions& options) {
  constexpr long kProgressEvery = 256;
  const auto& system = cast<Step>(opaque);
  Step stepper(system);
  auto state = load<Step>(z);
  Audit<Step> audit(system, plan.start, state);
  Recorder<Step> recorder(
      system,
      plan,
      options.times.empty() ? sample_times(plan, options.samples) : options.times,
      state);
  FlowSummary summary;
  summary.report =
      carnot::flow(stepper, plan, state, [&](long i, const Step& step, const auto& node) {
        audit(plan.time(i + 1), step, node);
        if (!std::isfinite(audit.energy_drift())) return false;
        recorder(i, node);
        if (!options.progress || i % kProgressEvery != 0) return true;
        return options.progress(static_cast<double>(i) / static_cast<double>(plan.count));
      });
  view<Step::kSize>(z) = state.value;
  if (!std::isfinite(audit.energy_drift())) {
    summary.report.status = FlowStatus::kStepFailed;
    summary.report.last.status = StepStatus::kRateFailed;
    summary.report.last.rate = RateStatus::kNotFinite;
  }
  summary.action = audit.action();
  summary.length = audit.length();
  summary.energy_drift = audit.energy_drift();
  summary.constraint_error = audit.constraint_error();
  summary.trajectory = recorder.trajectory();
  return summary;
}

template <class System>
PointValues evaluate(const void* opaque,
                     double t,
                     const double* q_in,
                     const double* p_in,
                     double* q_dot,
                     double* lambda_out) {
  using Q = Vector<double, System::kDof>;
  const auto& system = *static_cast<const System*>(opaque);
  const Q q = view<System::kDof>(q_in);
  const Q p = view<System::kDof>(p_in);
  Vector<double, System::kAlgebraic> y = Vector<double, System::kAlgebraic>::Zero();
  Vector<double, System::kMultipliers> lambda = Vector<double, System::kMultipliers>::Zero();
  Rate<double, System::kDof> rate;
  PointValues values;
  values.status = system.rate(t, q, p, y, rate);
  if (values.status != RateStatus::kOk) return values;
  values.status = system.multipliers(q, p, rate.q_dot, lambda);
  values.hamiltonian = system.hamiltonian(t, q, p, y);
  view<System::kDof>(q_dot) = rate.q_dot;
  view<System::kMultipliers>(lambda_out) = lambda;
  return values;
}

template <class System>
double momentum(
    const void* opaque, const double* q_in, double* q_dot, const double* lambda, double* p) {
  using Q = Vector<double, System::kDof>;
  using K = Vector<double, System::kMultipliers>;
  const auto& system = *static_cast<const System*>(opaque);
  const Q q = view<System::kDof>(q_in);
  Q v = view<System::kDof>(q_dot);
  const double size = v.norm();
  const double violated = system.constraint(q, v).norm();
  if (system.project(q, v) != RateStatus::kOk) v.setConstant(std::nan(""));
  view<System::kDof>(q_dot) = v;
  view<System::kDof>(p) = system.momentum(q, v, K(view<System::kMultipliers>(lambda)));
  return size > 0 ? violated / size : 0;
}

template <class System>
bool midpoint(
    const void* opaque, const double* qm_in, const double* v_in, double* terms, double* jacobian) {
  constexpr int n = System::kDof;
  constexpr int k = System::kMultipliers;
  const auto& system = *static_cast<const System*>(opaque);
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

template <class System>
void discrete_lagrangian(
    const void* opaque, double h, const double* x_in, double* gradient_out, double* hessian) {
  constexpr int m = 2 * System::kDof + System::kMultipliers;
  const auto& system = *static_cast<const System*>(opaque);
  const Vector<double, m> x = view<m>(x_in);
  Vector<double, m> slope;
  Matrix<double, m, m> second;
  carnot::discrete_lagrangian(system, h, x, slope, hessian != nullptr ? &second : nullptr);
  view<m>(gradient_out) = slope;
  if (hessian != nullptr) view<m * m>(hessian) = view<m * m>(second.data());
}

}  // namespace segment_calls

// A Segment of the scene with the Gauss method of s stages (order 2s). Throws
// std::invalid_argument when a parameter of the scene is out of its range.
template <int s, VelocityConstrainedScene Scene>
Segment make_gauss_segment(const Scene& scene) {
  validate(scene);
  using System = VelocityConstraints<Scene>;
  using Step = Gauss<System, s>;
  Segment segment;
  segment.dof = Scene::kDof;
  segment.multipliers = Scene::kMultipliers;
  segment.order = Step::kOrder;
  segment.info = describe_scene(scene);
  segment.system = std::make_shared<const System>(scene);
  segment.calls = {segment_calls::flow<Step>,
                   segment_calls::tangent_flow<Step>,
                   segment_calls::audited_flow<Step>,
                   segment_calls::evaluate<System>,
                   segment_calls::momentum<System>,
                   segment_calls::midpoint<System>,
                   segment_calls::discrete_lagrangian<System>};
  return segment;
}

}  // namespace carnot
