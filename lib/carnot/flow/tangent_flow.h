// The flow together with its derivative M = d(q,p)(t)/d(q,p)(0), exact for the discrete map.
#pragma once

#include "carnot/flow/flow.h"
#include "carnot/numerics/canonical_structure.h"
#include "carnot/step/tangent.h"

namespace carnot {

// What m is the derivative of: z by its value at the start, or at the step before.
enum class TangentOf { kFlow, kStep };

// Advances z and m; start with m = identity. `m` is d z(t)/d z(0), 2n x 2n, and of steps the
// identity again after each one was observed. The observer is that of flow(). A tangent that cannot
// be formed counts as a failed rate; m is then that of the step before.
template <class Stepper, class Observer>
FlowReport tangent_flow(
    Stepper& stepper,
    const StepPlan& plan,
    State<typename Stepper::Scalar, Stepper::kDof>& z,
    Compensated<Matrix<typename Stepper::Scalar, Stepper::kSize, Stepper::kSize>>& m,
    Observer&& observe,
    TangentOf of = TangentOf::kFlow) {
  Tangent<Stepper> tangent;
  bool tangent_ok = true;
  FlowReport report = flow(stepper, plan, z, [&](long i, const Stepper& done, auto& state) {
    tangent_ok = tangent.advance(done, m);
    const bool goes_on = tangent_ok && observe(i, done, state);
    if (goes_on && of == TangentOf::kStep) tangent.restart(m);
    return goes_on;
  });
  if (!tangent_ok) {
    report.status = FlowStatus::kStepFailed;
    report.last.status = StepStatus::kRateFailed;
    report.last.rate = tangent.failure();
  }
  return report;
}

// max-norm of M'JM - J. Zero for a symplectic M.
template <class T, int size>
T symplecticity_defect(const Matrix<T, size, size>& m) {
  const auto j = canonical_structure<Matrix<T, size, size>>(size, size / 2);
  return (m.transpose() * j * m - j).cwiseAbs().maxCoeff();
}

}  // namespace carnot
