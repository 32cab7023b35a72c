// Geodesics to many targets near one that is known, each in a few flows: for planners.
//
// A cubic model of p0 -> q(T) leads near each target (end_point_model.h); from there flows and
// Broyden's updates of the inverse Jacobian lead to it, superlinearly (Dennis & Schnabel, Numerical
// Methods for Unconstrained Optimization and Nonlinear Equations, 8.1). Steps, and how well their
// stages are solved, are those of automatic_flow.h: rough ones far from the target, stricter ones
// for the flow that should arrive, whose end is the check. All of it is done in the natural scales
// of the problem (problem/natural_scales.h), so that units do not matter.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot {

struct WarmStartReport {
  bool converged = false;  // endpoint_error is within the tolerance
  // max-norm of q(T) - to over the natural scales of the coordinates, of an integration with a
  // hundredth of the error.
  double endpoint_error = std::numeric_limits<double>::infinity();
  int flows = 0;
};

// Cheap to copy.
class WarmStart {
 public:
  // From p0, an extremal of `problem`: n^2 + n + 1 tangent flows. Where the start is free in
  // coordinate j, here and below p0_j stands for q_j(0). `tolerance`: the largest endpoint_error
  // of an answer. Throws std::invalid_argument on bad input.
  WarmStart(const BoundaryValueProblem& problem,
            const std::vector<double>& p0,
            double tolerance = 1e-10);

  // False where p0 does not arrive, or dq(T)/dp0 is singular or so large that single shooting loses
  // its digits: solve() then fails at once.
  [[nodiscard]] bool ready() const;

  // The geodesic from `from` to `to` (length n; what is free does not count) that belongs to the
  // same branch, if it is near: its momentum in `p0` (length n). On failure p0 is that of the known
  // extremal. Thread-safe, no allocation.
  [[nodiscard]] WarmStartReport solve(const double* to, double* p0) const;

 private:
  class Implementation;
  std::shared_ptr<const Implementation> own_;
};

}  // namespace carnot
