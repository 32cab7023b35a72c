// The derivative M of the flow and how symplectic it is.
#pragma once

#include <vector>

#include "carnot/dynamics.h"

namespace carnot {

struct TangentMap {
  FlowStatus status = FlowStatus::kCompleted;
  std::vector<double> m;       // d(q,p)(end)/d(q,p)(start), row-major 2n x 2n
  double defect = 0;           // max-norm of M'JM - J, J = (0, -I; I, 0)
  double relative_defect = 0;  // the same / max(1, |M|^2), |M| the Frobenius norm
};

// Starts from z = (q, p) at plan.start. Runs in pieces, so that `progress` can stop it.
TangentMap tangent_along(const Dynamics& dynamics,
                         const StepPlan& plan,
                         std::vector<double> z,
                         const Progress& progress);

}  // namespace carnot
