#include "carnot/shooting/problem/rescaled.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "carnot/numerics/pack.h"
#include "carnot/system/system_functions.h"
#include "carnot/transcription/transcription_functions.h"

namespace carnot::internal {
namespace {

// What the calls of a rescaled scene take: the scene, and the unit of each number.
struct Rescaled {
  Dynamics own;
  NaturalScales scales;
  std::vector<double> z;  // the units of phase points, 2n
  SystemFunctions functions;
  TranscriptionFunctions transcription;

  Rescaled(const Dynamics& dynamics, const NaturalScales& natural);

  static const Rescaled& from(const void* opaque) { return *static_cast<const Rescaled*>(opaque); }
  [[nodiscard]] int dof() const { return own.dof; }
  [[nodiscard]] const void* system() const { return own.system.get(); }
  // With these the multipliers' term of l, in units of an energy, has the weight one.
  [[nodiscard]] GaugeUnits gauge() const { return {z.data(), 1 / (scales.action * scales.time)}; }

  // `count` numbers in units of the scene; and back. Both may be the same place.
  static void scale(const double* from, const std::vector<double>& units, int count, double* to) {
    for (int i = 0; i < count; ++i) to[i] = from[i] * units[i];
  }
  static void unscale(const double* from, const std::vector<double>& units, int count, double* to) {
    for (int i = 0; i < count; ++i) to[i] = from[i] / units[i];
  }
  // Rows of kErasedLanes numbers.
  void scale_rows(const double* from, int count, double* to) const {
    for (int i = 0; i < count; ++i) scale_row(from + i * kErasedLanes, z[i], to + i * kErasedLanes);
  }
  static void scale_row(const double* from, double unit, double* to) {
    (Pack<kErasedLanes>::load(from) * Pack<kErasedLanes>(unit)).store(to);
  }
  [[nodiscard]] StepPlan in_own_time(StepPlan plan) const {
    for (double* t : {&plan.start, &plan.end, &plan.step, &plan.last}) *t *= scales.time;
    return plan;
  }
};

// Memory for the arguments of one call; the calls do not call each other.
double* scratch(int count) {
  thread_local std::vector<double> memory;
  if (memory.size() < static_cast<std::size_t>(count)) memory.resize(count);
  return memory.data();
}

// --- the system ----------------------------------------------------------------------------------

RateStatus rate(const void* opaque, double t, const double* z, double* y, double* z_dot) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  double* const at = scratch(size);
  Rescaled::scale(z, r.z, size, at);
  const RateStatus status = r.own.functions->rate(r.system(), r.scales.time * t, at, y, z_dot);
  if (status != RateStatus::kOk) return status;
  for (int i = 0; i < size; ++i) z_dot[i] *= r.scales.time / r.z[i];
  return status;
}

RateStatus jacobian(const void* opaque, double t, const double* z, const double* y, double* out) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  double* const at = scratch(size);
  Rescaled::scale(z, r.z, size, at);
  const RateStatus status = r.own.functions->jacobian(r.system(), r.scales.time * t, at, y, out);
  for (int column = 0; column < size; ++column) {
    for (int row = 0; row < size; ++row) {
      out[column * size + row] *= r.scales.time * r.z[column] / r.z[row];
    }
  }
  return status;
}

// Times of kErasedLanes points and their phase points, in units of the scene.
struct Points {
  double* t;
  double* z;
  double* rest;  // more rows
};
Points points_of(const Rescaled& r, const double* t, const double* z, int more_rows) {
  const int size = 2 * r.dof();
  double* const memory = scratch((1 + size + more_rows) * kErasedLanes);
  const Points points{memory, memory + kErasedLanes, memory + (1 + size) * kErasedLanes};
  Rescaled::scale_row(t, r.scales.time, points.t);
  r.scale_rows(z, size, points.z);
  return points;
}

bool rates(const void* opaque, const double* t, const double* z, double* y, double* z_dot) {
  const Rescaled& r = Rescaled::from(opaque);
  const Points at = points_of(r, t, z, 0);
  if (!r.own.functions->rates(r.system(), at.t, at.z, y, z_dot)) return false;
  for (int i = 0; i < 2 * r.dof(); ++i) {
    double* const row = z_dot + i * kErasedLanes;
    Rescaled::scale_row(row, r.scales.time / r.z[i], row);
  }
  return true;
}

bool jacobians(
    const void* opaque, const double* t, const double* z, const double* weights, double* jacobian) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  const Points at = points_of(r, t, z, 0);
  if (!r.own.functions->jacobians(r.system(), at.t, at.z, weights, jacobian)) return false;
  for (int entry = 0; entry < size * size; ++entry) {
    const double unit = r.scales.time * r.z[entry % size] / r.z[entry / size];
    double* const row = jacobian + entry * kErasedLanes;
    Rescaled::scale_row(row, unit, row);
  }
  return true;
}

double hamiltonian(
    const void* opaque, double t, const double* q, const double* p, const double* y) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  double* const at = scratch(2 * n);
  for (int j = 0; j < n; ++j) at[j] = q[j] * r.z[j];
  for (int j = 0; j < n; ++j) at[n + j] = p[j] * r.z[n + j];
  return r.own.functions->hamiltonian(r.system(), r.scales.time * t, at, at + n, y) /
         r.scales.energy();
}

RateStatus find_multipliers(const void* opaque,
                            double t,
                            const double* q,
                            const double* p,
                            const double* y,
                            double* lambda) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  double* const at = scratch(2 * n);
  for (int j = 0; j < n; ++j) at[j] = q[j] * r.z[j];
  for (int j = 0; j < n; ++j) at[n + j] = p[j] * r.z[n + j];
  const RateStatus status =
      r.own.functions->find_multipliers(r.system(), r.scales.time * t, at, at + n, y, lambda);
  Rescaled::unscale(lambda, r.scales.multipliers, r.own.multipliers, lambda);
  return status;
}

void measure(const void* opaque,
             int count,
             const double* t,
             const double* weights,
             const double* z,
             const double* dq,
             const double* y,
             PointMeasures* out) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  const Points at = points_of(r, t, z, n + 1);
  double* const steps = at.rest + n * kErasedLanes;
  r.scale_rows(dq, n, at.rest);
  for (int l = 0; l < kErasedLanes; ++l) steps[l] = r.scales.time * weights[l];
  r.own.functions->measure(r.system(), count, at.t, steps, at.z, at.rest, y, out);
  for (int l = 0; l < count; ++l) {
    out[l].lagrangian /= r.scales.energy();
    out[l].speed *= r.scales.time / r.scales.length();
    out[l].power *= r.scales.time / r.scales.energy();
  }
}

NodeMeasures measure_node(const void* opaque, double t, const double* z, double* y) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  double* const at = scratch(size);
  Rescaled::scale(z, r.z, size, at);
  NodeMeasures measures = r.own.functions->measure_node(r.system(), r.scales.time * t, at, y);
  measures.hamiltonian /= r.scales.energy();
  return measures;
}

void branch(const void* opaque, double* y) {
  const Rescaled& r = Rescaled::from(opaque);
  r.own.functions->branch(r.system(), y);
}

// --- the transcription ---------------------------------------------------------------------------

// The units of velocities in the entries: with a gauge those of the coordinates, see
// transcription_functions.h.
double velocity_unit(const Rescaled& r, int j) { return r.transcription.gauge ? 1 : r.z[j]; }

// The entries of `lanes` points side by side, in rows of `length` numbers each.
template <int lanes>
void convert_entries(const Rescaled& r, bool slopes, int length, double* out) {
  const int n = r.dof();
  double* row = out;
  const auto multiply = [&](int number, double unit) {
    for (int l = 0; l < lanes; ++l) row[number * lanes + l] *= unit;
  };
  const auto convert = [&](double unit) {
    multiply(0, unit);
    for (int d = 0; slopes && d < n; ++d) multiply(1 + d, unit * r.z[d]);
    row += length * lanes;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      convert(velocity_unit(r, i) * velocity_unit(r, j) / (r.scales.action * r.scales.time));
    }
  }
  for (int i = 0; i < r.own.transcribed; ++i) {
    for (int j = 0; j < n; ++j) convert(velocity_unit(r, j) / r.scales.rows[i]);
  }
  convert(1 / r.scales.energy());
}

void entries(
    const void* opaque, const double* q, const GaugeUnits& /*units*/, bool slopes, double* out) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  double* const at = scratch(n);
  Rescaled::scale(q, r.z, n, at);
  r.own.transcription->entries(r.system(), at, r.gauge(), slopes, out);
  convert_entries<1>(r, slopes, slopes ? row_length(n) : 1, out);
}

void packed_entries(
    const void* opaque, const double* q, const GaugeUnits& /*units*/, bool slopes, double* out) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  double* const at = scratch(n * kTranscriptionLanes);
  static_assert(kErasedLanes == kTranscriptionLanes);
  r.scale_rows(q, n, at);
  r.own.transcription->packed_entries(r.system(), at, r.gauge(), slopes, out);
  convert_entries<kErasedLanes>(r, slopes, slopes ? 1 + n : 1, out);
}

// The arguments of a Hessian in units of the scene, of `lanes` points side by side.
struct HessianArguments {
  double* q;
  double* v;
  double* lambda;
};
template <int lanes>
HessianArguments hessian_arguments(const Rescaled& r,
                                   const double* q,
                                   const double* v,
                                   const double* lambda) {
  const int n = r.dof();
  const int k = r.own.transcribed;
  double* const at = scratch((2 * n + k) * lanes);
  const HessianArguments own{at, at + n * lanes, at + 2 * n * lanes};
  for (int j = 0; j < n; ++j) {
    const double speed = velocity_unit(r, j) / r.scales.time;
    for (int l = j * lanes; l < (j + 1) * lanes; ++l) own.q[l] = q[l] * r.z[j];
    for (int l = j * lanes; l < (j + 1) * lanes; ++l) own.v[l] = v[l] * speed;
  }
  for (int i = 0; i < k; ++i) {
    const double unit = r.scales.action / r.scales.rows[i];
    for (int l = i * lanes; l < (i + 1) * lanes; ++l) own.lambda[l] = lambda[l] * unit;
  }
  return own;
}
template <int lanes>
void convert_hessian(const Rescaled& r, double* l_qq) {
  const int n = r.dof();
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double unit = r.z[i] * r.z[j] / r.scales.energy();
      for (int l = 0; l < lanes; ++l) l_qq[(i * n + j) * lanes + l] *= unit;
    }
  }
}

void hessian(const void* opaque,
             const double* q,
             const double* v,
             const double* lambda,
             const GaugeUnits& /*units*/,
             double* l_qq) {
  const Rescaled& r = Rescaled::from(opaque);
  const HessianArguments own = hessian_arguments<1>(r, q, v, lambda);
  r.own.transcription->hessian(r.system(), own.q, own.v, own.lambda, r.gauge(), l_qq);
  convert_hessian<1>(r, l_qq);
}

void packed_hessian(const void* opaque,
                    const double* q,
                    const double* v,
                    const double* lambda,
                    const GaugeUnits& /*units*/,
                    double* l_qq) {
  const Rescaled& r = Rescaled::from(opaque);
  const HessianArguments own = hessian_arguments<kErasedLanes>(r, q, v, lambda);
  r.own.transcription->packed_hessian(r.system(), own.q, own.v, own.lambda, r.gauge(), l_qq);
  convert_hessian<kErasedLanes>(r, l_qq);
}

// --- flows ---------------------------------------------------------------------------------------

void convert(const Rescaled& r, FlowReport& report) { report.time_reached /= r.scales.time; }

FlowReport flow(const void* opaque, const void*, const StepPlan& plan, double* z) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  Rescaled::scale(z, r.z, size, z);
  FlowReport report = r.own.flow(r.in_own_time(plan), {z, static_cast<std::size_t>(size)});
  Rescaled::unscale(z, r.z, size, z);
  convert(r, report);
  return report;
}

FlowReport tangent_flow(
    const void* opaque, const void*, const StepPlan& plan, double* z, double* m, double* nodes) {
  const Rescaled& r = Rescaled::from(opaque);
  const std::size_t size = 2 * static_cast<std::size_t>(r.dof());
  const StepPlan own = r.in_own_time(plan);
  const std::size_t maps = nodes == nullptr ? 1 : static_cast<std::size_t>(plan.count);
  const std::span<double> at(z, size);
  const std::span<double> tangents(m, maps * size * size);
  Rescaled::scale(z, r.z, 2 * r.dof(), z);
  FlowReport report = nodes == nullptr
                          ? r.own.tangent_flow(own, at, tangents)
                          : r.own.tangent_steps(own, at, {nodes, maps * size}, tangents);
  Rescaled::unscale(z, r.z, 2 * r.dof(), z);
  for (std::size_t i = 0; i < maps; ++i) {
    if (nodes != nullptr) {
      Rescaled::unscale(nodes + i * size, r.z, 2 * r.dof(), nodes + i * size);
    }
    for (std::size_t entry = 0; entry < size * size; ++entry) {
      tangents[i * size * size + entry] *= r.z[entry % size] / r.z[entry / size];
    }
  }
  convert(r, report);
  return report;
}

FlowSummary monitored_flow(const void* opaque,
                           const void*,
                           const StepPlan& plan,
                           double* z,
                           const MonitorOptions& options) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  MonitorOptions own = options;
  for (double& t : own.times) t *= r.scales.time;
  Rescaled::scale(z, r.z, 2 * n, z);
  FlowSummary summary =
      r.own.monitored_flow(r.in_own_time(plan), {z, static_cast<std::size_t>(2 * n)}, own);
  Rescaled::unscale(z, r.z, 2 * n, z);
  convert(r, summary.report);
  summary.action /= r.scales.action;
  summary.length /= r.scales.length();
  summary.energy_drift /= r.scales.energy();
  summary.energy_balance /= r.scales.energy();
  Trajectory& samples = summary.trajectory;
  for (double& t : samples.t) t /= r.scales.time;
  for (double& energy : samples.hamiltonian) energy /= r.scales.energy();
  for (auto& q : samples.q) Rescaled::unscale(q.data(), r.z, n, q.data());
  for (auto& p : samples.p) {
    for (int j = 0; j < n; ++j) p[j] /= r.z[n + j];
  }
  for (auto& lambda : samples.lambda) {
    Rescaled::unscale(
        lambda.data(), r.scales.multipliers, static_cast<int>(lambda.size()), lambda.data());
  }
  return summary;
}

// --- the rest ------------------------------------------------------------------------------------

// (q, p) in units of the scene.
std::vector<double> phase_point(const Rescaled& r, const double* q, const double* p) {
  const int n = r.dof();
  std::vector<double> z(2 * n);
  for (int j = 0; j < n; ++j) z[j] = q[j] * r.z[j];
  for (int j = 0; j < n; ++j) z[n + j] = p[j] * r.z[n + j];
  return z;
}

Regularity regularity(const void* opaque, double t, const double* q, const double* p) {
  const Rescaled& r = Rescaled::from(opaque);
  const std::vector<double> z = phase_point(r, q, p);
  return r.own.calls.regularity(r.system(), r.scales.time * t, z.data(), z.data() + r.dof());
}

double chart(const void* opaque, const double* q) {
  const Rescaled& r = Rescaled::from(opaque);
  std::vector<double> at(r.dof());
  Rescaled::scale(q, r.z, r.dof(), at.data());
  return r.own.calls.chart(r.system(), at.data());
}

double momentum(
    const void* opaque, double t, const double* q, double* q_dot, const double* lambda, double* p) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  std::vector<double> at(n);
  std::vector<double> multipliers(r.own.multipliers);
  Rescaled::scale(q, r.z, n, at.data());
  Rescaled::scale(lambda, r.scales.multipliers, r.own.multipliers, multipliers.data());
  for (int j = 0; j < n; ++j) q_dot[j] *= r.z[j] / r.scales.time;
  const double violated =
      r.own.calls.momentum(r.system(), r.scales.time * t, at.data(), q_dot, multipliers.data(), p);
  for (int j = 0; j < n; ++j) q_dot[j] *= r.scales.time / r.z[j];
  for (int j = 0; j < n; ++j) p[j] /= r.z[n + j];
  return violated;
}

void holonomic(
    const void* opaque, double t, const double* z, double* h, double* dh, double* q_dot) {
  const Rescaled& r = Rescaled::from(opaque);
  const int n = r.dof();
  const std::vector<double> at = phase_point(r, z, z + n);
  r.own.calls.holonomic(r.system(), r.scales.time * t, at.data(), h, dh, q_dot);
  for (int i = 0; i < r.own.holonomic; ++i) {
    for (int j = 0; j < n; ++j) dh[i * n + j] *= r.z[j];
  }
  for (int j = 0; j < n; ++j) q_dot[j] *= r.scales.time / r.z[j];
}

// With holonomic constraints all coordinates have the unit one, so that what is normal stays it.
bool project_on_manifold(const void* opaque, double t, double* z) {
  const Rescaled& r = Rescaled::from(opaque);
  Rescaled::scale(z, r.z, 2 * r.dof(), z);
  const bool projected = r.own.calls.project_on_manifold(r.system(), r.scales.time * t, z);
  Rescaled::unscale(z, r.z, 2 * r.dof(), z);
  return projected;
}

bool tangent_projector(const void* opaque, double t, const double* z, double* projector) {
  const Rescaled& r = Rescaled::from(opaque);
  const int size = 2 * r.dof();
  const std::vector<double> at = phase_point(r, z, z + r.dof());
  if (!r.own.calls.tangent_projector(r.system(), r.scales.time * t, at.data(), projector))
    return false;
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      projector[row * size + column] *= r.z[column] / r.z[row];
    }
  }
  return true;
}

Rescaled::Rescaled(const Dynamics& dynamics, const NaturalScales& natural)
    : own(dynamics), scales(natural), z(natural.q), functions(*dynamics.functions) {
  for (int j = 0; j < dof(); ++j) z.push_back(scales.momentum(j));
  functions.rate = internal::rate;
  functions.jacobian = internal::jacobian;
  functions.rates = internal::rates;
  functions.jacobians = internal::jacobians;
  functions.iterate = nullptr;
  functions.hamiltonian = internal::hamiltonian;
  functions.find_multipliers = internal::find_multipliers;
  functions.measure = internal::measure;
  functions.measure_node = internal::measure_node;
  functions.branch = internal::branch;
  if (!own.has_transcription()) return;
  transcription = *own.transcription;
  transcription.entries = internal::entries;
  transcription.hessian = internal::hessian;
  if (transcription.packed_entries != nullptr) {
    transcription.packed_entries = internal::packed_entries;
    transcription.packed_hessian = internal::packed_hessian;
  }
}

}  // namespace

Dynamics rescaled(const Dynamics& dynamics, const NaturalScales& scales) {
  const auto system = std::make_shared<Rescaled>(dynamics, scales);
  Dynamics result = dynamics;
  result.system = system;
  result.functions = &system->functions;
  if (dynamics.has_transcription()) result.transcription = &system->transcription;
  result.kernel.calls = {flow, tangent_flow, monitored_flow, nullptr};
  const auto replace = [](auto& call, auto* with) {
    if (call != nullptr) call = with;
  };
  replace(result.calls.regularity, regularity);
  replace(result.calls.chart, chart);
  replace(result.calls.momentum, momentum);
  result.calls.branch = nullptr;
  replace(result.calls.holonomic, holonomic);
  replace(result.calls.project_on_manifold, project_on_manifold);
  replace(result.calls.tangent_projector, tangent_projector);
  for (Extreme& extreme : result.info.extremes) {
    extreme.value = [system, value = std::move(extreme.value)](const double* q) {
      std::vector<double> at(system->dof());
      Rescaled::scale(q, system->z, system->dof(), at.data());
      return value(at.data());
    };
  }
  result.info.limits.clear();
  return result;
}

namespace {

// Values stay; what they depend on is in other units.
Limit rescaled(const Limit& limit, const NaturalScales& scales) {
  Limit result = limit;
  result.value = [value = limit.value, units = scales.q](
                     const double* q, double* gradient, double* hessian) {
    const std::size_t n = units.size();
    double* const at = scratch(static_cast<int>(n));
    for (std::size_t j = 0; j < n; ++j) at[j] = q[j] * units[j];
    const double found = value(at, gradient, hessian);
    for (std::size_t j = 0; j < n && gradient != nullptr; ++j) gradient[j] *= units[j];
    for (std::size_t e = 0; e < n * n && hessian != nullptr; ++e) {
      hessian[e] *= units[e / n] * units[e % n];
    }
    return found;
  };
  if (limit.held) {
    result.held = [held = limit.held, scales] {
      const Dynamics dynamics = held();
      // Its flows alone are asked for, so the unit of the one row more is of no consequence.
      NaturalScales with_row = scales;
      with_row.rows.resize(dynamics.transcribed, 1.0);
      with_row.multipliers.resize(dynamics.multipliers, scales.action);
      return internal::rescaled(dynamics, with_row);
    };
  }
  return result;
}

}  // namespace

BoundaryValueProblem rescaled(const BoundaryValueProblem& problem, const NaturalScales& scales) {
  BoundaryValueProblem result = problem;
  result.dynamics = rescaled(problem.dynamics, scales);
  for (std::size_t j = 0; j < scales.q.size(); ++j) {
    result.from[j] /= scales.q[j];
    result.to[j] /= scales.q[j];
  }
  result.time /= scales.time;
  for (Limit& limit : result.limits) limit = rescaled(limit, scales);
  return result;
}

void put_in_own_units(const NaturalScales& scales, Geodesic& geodesic) {
  const int n = static_cast<int>(scales.q.size());
  const auto put_q = [&](std::vector<double>& q) {
    for (std::size_t j = 0; j < q.size(); ++j) q[j] *= scales.q[j];
  };
  const auto put_p = [&](std::vector<double>& p) {
    for (std::size_t j = 0; j < p.size(); ++j) p[j] *= scales.momentum(static_cast<int>(j));
  };
  const auto put_lambda = [&](std::vector<double>& lambda) {
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] *= scales.multipliers[i];
  };
  const auto largest = [&](const auto& unit) {
    double size = 0;
    for (int j = 0; j < n; ++j) size = std::max(size, unit(j));
    return size;
  };
  const double largest_q = largest([&](int j) { return scales.q[j]; });
  const double largest_p = largest([&](int j) { return scales.momentum(j); });
  geodesic.endpoint_error *= largest_q;
  geodesic.transversality_error *= largest_p;
  geodesic.knot_defect *= std::max(largest_q, largest_p);
  geodesic.grid_error *= scales.action;
  for (LimitReport& limit : geodesic.limits) {
    limit.largest_multiplier *= scales.energy();
    for (auto& [begin, end] : limit.active) {
      begin *= scales.time;
      end *= scales.time;
    }
  }
  put_q(geodesic.from);
  put_q(geodesic.to);
  put_p(geodesic.p0);
  put_lambda(geodesic.lambda0);
  geodesic.action *= scales.action;
  if (geodesic.length) *geodesic.length *= scales.length();
  geodesic.energy_drift *= scales.energy();
  if (geodesic.conjugate_times) {
    for (double& t : *geodesic.conjugate_times) t *= scales.time;
  }
  for (double* t :
       {&geodesic.plan.start, &geodesic.plan.end, &geodesic.plan.step, &geodesic.plan.last}) {
    *t *= scales.time;
  }
  Trajectory& samples = geodesic.trajectory;
  for (double& t : samples.t) t *= scales.time;
  for (double& energy : samples.hamiltonian) energy *= scales.energy();
  for (auto& q : samples.q) put_q(q);
  for (auto& p : samples.p) put_p(p);
  for (auto& lambda : samples.lambda) put_lambda(lambda);
}

void put_in_own_units(const BoundaryValueProblem& problem,
                      const NaturalScales& scales,
                      Geodesic& geodesic) {
  put_in_own_units(scales, geodesic);
  for (int j = 0; j < problem.dynamics.dof; ++j) {
    if (!problem.is_free_from(j)) geodesic.from[j] = problem.from[j];
    if (!problem.is_free_to(j)) geodesic.to[j] = problem.to[j];
  }
}

}  // namespace carnot::internal
