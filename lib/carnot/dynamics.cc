#include "carnot/dynamics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "carnot/flow/batch.h"
#include "carnot/system/system_functions.h"
#include "carnot/transcription/midpoint_transcription.h"

namespace carnot {

PointValues Dynamics::evaluate(
    double t, const double* q, const double* p, double* q_dot, double* lambda) const {
  const void* const at = system.get();
  // z, its rate, and y.
  std::vector<double> memory(4 * dof + functions->algebraic);
  double* const z = memory.data();
  double* const z_dot = z + 2 * dof;
  double* const y = z_dot + 2 * dof;
  std::copy_n(q, dof, z);
  std::copy_n(p, dof, z + dof);
  functions->branch(at, y);
  PointValues values;
  if (calls.regularity != nullptr) values.regularity = calls.regularity(at, t, q, p);
  values.status = functions->rate(at, t, z, y, z_dot);
  if (values.status != RateStatus::kOk) return values;
  std::fill_n(lambda, multipliers, 0.0);
  values.status = functions->find_multipliers(at, t, q, p, y, lambda);
  values.hamiltonian = functions->hamiltonian(at, t, q, p, y);
  std::copy_n(z_dot, dof, q_dot);
  return values;
}

bool Dynamics::midpoint(const double* qm, const double* v, double* terms, double* jacobian) const {
  return midpoint_terms(*transcription, system.get(), qm, v, terms, jacobian);
}

void Dynamics::discrete_lagrangian(double h,
                                   const double* x,
                                   double* gradient,
                                   double* hessian) const {
  carnot::discrete_lagrangian(*transcription, system.get(), h, x, gradient, hessian);
}

void Dynamics::midpoint_multipliers(const double* q, const double* p, double* lambda) const {
  if (transcription->gauge) {
    gauged_multipliers(*transcription, system.get(), q, p, lambda);
    return;
  }
  std::fill_n(lambda, transcribed, 0.0);
  std::vector<double> velocity(dof);
  (void)evaluate(0, q, p, velocity.data(), lambda);
}

BatchReport Dynamics::flow_batch(const StepPlan& plan, int count, double* z, int threads) const {
  return batch_of(count, threads, [&](int i, BatchReport& report) {
    double* const point = z + i * 2 * dof;
    const FlowReport run = flow(plan, point);
    report.evaluations += run.evaluations;
    ++(run.completed() ? report.completed : report.failed);
    if (!run.completed()) std::fill_n(point, 2 * dof, std::nan(""));
  });
}

}  // namespace carnot
