#include "carnot/dynamics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include "carnot/flow/batch.h"
#include "carnot/scene/unit_sizes.h"
#include "carnot/system/system_functions.h"
#include "carnot/transcription/midpoint_transcription.h"

namespace carnot {
namespace {

// `worst`, or |value| / terms where that is larger, or NaN.
double larger_ratio(double worst, double value, double terms) {
  const double ratio = value == 0 ? 0 : std::abs(value) / terms;
  return ratio <= worst || std::isnan(worst) ? worst : ratio;
}

}  // namespace

HolonomicResiduals Dynamics::holonomic_residuals(double t, std::span<const double> z) const {
  assert(has_holonomic() && std::ssize(z) == 2 * dof);
  std::vector<double> h(holonomic);
  std::vector<double> dh(static_cast<std::size_t>(holonomic) * dof);
  std::vector<double> v(dof);
  calls.holonomic(system.get(), t, z.data(), h.data(), dh.data(), v.data());
  const std::vector<double> sizes = sizes_by_unit(info, z.first(dof), 1);
  const std::vector<double> speeds = sizes_by_unit(info, v, 0);
  HolonomicResiduals residuals;
  double leaving = 0;
  for (int i = 0; i < holonomic; ++i) {
    double terms = 0;
    double rate = 0;
    double rate_terms = 0;
    for (int j = 0; j < dof; ++j) {
      const double slope = dh[i * dof + j];
      terms += std::abs(slope) * sizes[j];
      rate += slope * v[j];
      rate_terms += std::abs(slope) * speeds[j];
    }
    residuals.position = larger_ratio(residuals.position, h[i], 1);
    residuals.relative_position = larger_ratio(residuals.relative_position, h[i], terms);
    leaving = larger_ratio(leaving, rate, rate_terms);
  }
  residuals.relative_velocity = leaving;
  return residuals;
}

PointValues Dynamics::evaluate(double t,
                               std::span<const double> q,
                               std::span<const double> p,
                               std::span<double> q_dot,
                               std::span<double> lambda) const {
  assert(std::ssize(q) == dof && std::ssize(p) == dof);
  assert(std::ssize(q_dot) == dof && std::ssize(lambda) == multipliers);
  const void* const at = system.get();
  // z, its rate, and y.
  std::vector<double> memory(4 * dof + functions->algebraic);
  double* const z = memory.data();
  double* const z_dot = z + 2 * dof;
  double* const y = z_dot + 2 * dof;
  std::copy(q.begin(), q.end(), z);
  std::copy(p.begin(), p.end(), z + dof);
  functions->branch(at, y);
  PointValues values;
  if (calls.regularity != nullptr) values.regularity = calls.regularity(at, t, q.data(), p.data());
  values.status = functions->rate(at, t, z, y, z_dot);
  if (values.status != RateStatus::kOk) return values;
  std::fill(lambda.begin(), lambda.end(), 0.0);
  values.status = functions->find_multipliers(at, t, q.data(), p.data(), y, lambda.data());
  values.hamiltonian = functions->hamiltonian(at, t, q.data(), p.data(), y);
  std::copy_n(z_dot, dof, q_dot.begin());
  return values;
}

bool Dynamics::midpoint(std::span<const double> qm,
                        std::span<const double> v,
                        std::span<double> terms,
                        std::span<double> jacobian) const {
  assert(has_transcription() && std::ssize(qm) == dof && std::ssize(v) == dof);
  assert(std::ssize(terms) == dof + transcribed + 1);
  assert(jacobian.empty() || std::ssize(jacobian) == std::ssize(terms) * 2 * dof);
  return midpoint_terms(*transcription,
                        system.get(),
                        qm.data(),
                        v.data(),
                        terms.data(),
                        jacobian.empty() ? nullptr : jacobian.data());
}

void Dynamics::discrete_lagrangian(double h,
                                   std::span<const double> x,
                                   std::span<double> gradient,
                                   std::span<double> hessian) const {
  assert(has_transcription() && std::ssize(x) == 2 * dof + transcribed);
  assert(gradient.size() == x.size());
  assert(hessian.empty() || hessian.size() == x.size() * x.size());
  carnot::discrete_lagrangian(*transcription,
                              system.get(),
                              h,
                              x.data(),
                              gradient.data(),
                              hessian.empty() ? nullptr : hessian.data());
}

bool Dynamics::midpoints(std::span<const double> qm,
                         std::span<const double> v,
                         std::span<double> terms,
                         std::span<double> jacobian) const {
  static_assert(kMidpointLanes == kTranscriptionLanes);
  assert(has_transcription() && std::ssize(qm) == dof * kMidpointLanes && v.size() == qm.size());
  assert(std::ssize(terms) == (dof + transcribed + 1) * kMidpointLanes);
  assert(jacobian.empty() || std::ssize(jacobian) == std::ssize(terms) * 2 * dof);
  return packed_midpoint_terms(*transcription,
                               system.get(),
                               qm.data(),
                               v.data(),
                               terms.data(),
                               jacobian.empty() ? nullptr : jacobian.data());
}

void Dynamics::discrete_lagrangians(double h,
                                    std::span<const double> x,
                                    std::span<double> gradient,
                                    std::span<double> hessian) const {
  assert(has_transcription() && std::ssize(x) == (2 * dof + transcribed) * kMidpointLanes);
  assert(gradient.size() == x.size());
  assert(hessian.empty() || hessian.size() == x.size() * (2 * dof + transcribed));
  packed_discrete_lagrangian(*transcription,
                             system.get(),
                             h,
                             x.data(),
                             gradient.data(),
                             hessian.empty() ? nullptr : hessian.data());
}

void Dynamics::midpoint_multipliers(std::span<const double> q,
                                    std::span<const double> p,
                                    std::span<double> lambda) const {
  assert(has_transcription() && std::ssize(q) == dof && std::ssize(p) == dof);
  assert(std::ssize(lambda) == transcribed);
  if (transcription->gauge) {
    gauged_multipliers(*transcription, system.get(), q.data(), p.data(), lambda.data());
    return;
  }
  std::fill(lambda.begin(), lambda.end(), 0.0);
  std::vector<double> velocity(dof);
  (void)evaluate(0, q, p, velocity, lambda);
}

BatchReport Dynamics::adaptive_batch(double start,
                                     double duration,
                                     double tolerance,
                                     int count,
                                     std::span<double> z,
                                     int threads) const {
  assert(has_adaptive_batch() && std::ssize(z) == 2L * dof * count);
  const AdaptiveFlow flow{*functions, system.get(), start, duration, tolerance};
  return carnot::adaptive_batch(flow, count, z.data(), threads);
}

BatchReport Dynamics::flow_batch(const StepPlan& plan,
                                 int count,
                                 std::span<double> z,
                                 int threads) const {
  const int size = 2 * dof;
  assert(std::ssize(z) == 2L * dof * count);
  return batch_of(count, threads, [&](int i, BatchReport& report) {
    const auto point = z.subspan(static_cast<std::size_t>(i) * size, size);
    const FlowReport run = flow(plan, point);
    report.evaluations += run.evaluations;
    ++(run.completed() ? report.completed : report.failed);
    if (!run.completed()) std::fill(point.begin(), point.end(), std::nan(""));
  });
}

}  // namespace carnot
