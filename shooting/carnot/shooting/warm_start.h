// Geodesics to many targets near one that is known, each in a few flows: for planners.
//
// Tangent flows about the known extremal give the first and second derivatives of p0 -> q(T). For
// each target the quadratic model is solved first; then flows and Broyden's updates of the inverse
// Jacobian lead to the target, superlinearly (Dennis & Schnabel, Numerical Methods for
// Unconstrained Optimization and Nonlinear Equations, 8.1). Steps, and how well their stages are
// solved, are those of automatic_flow.h; the flow that should arrive takes stricter ones, and its
// end is the check.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot {

struct WarmStartReport {
  bool converged = false;  // endpoint_error is within the tolerance
  // max-norm of q(T) - to, of an integration with half the steps' length and stricter stages.
  double endpoint_error = std::numeric_limits<double>::infinity();
  int flows = 0;
};

class WarmStart {
 public:
  // From p0, an extremal of `problem`: 2n + 1 tangent flows. Throws std::invalid_argument on bad
  // input.
  WarmStart(const BoundaryValueProblem& problem,
            const std::vector<double>& p0,
            double tolerance = 1e-10);

  // False where p0 does not arrive, or dq(T)/dp0 is singular or so large that single shooting loses
  // its digits: solve() then fails at once.
  [[nodiscard]] bool ready() const { return ready_; }

  // The geodesic from `from` to `to` (length n) that belongs to the same branch, if it is near: its
  // momentum in `p0` (length n). On failure p0 is that of the known extremal. Thread-safe, no
  // allocation.
  [[nodiscard]] WarmStartReport solve(const double* to, double* p0) const;

 private:
  static constexpr int kMostDof = 16;
  using Small = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostDof, 1>;
  using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostDof, kMostDof>;

  // The derivatives of q(T) at p0_; false where the first one cannot be inverted.
  [[nodiscard]] bool differentiate();
  // The change of p0 that takes the quadratic model to `to`, and the inverse Jacobian there; that
  // of the linear model where the quadratic one does not reach it.
  void predict(const Small& change_of_end, Small& change, SmallMatrix& inverse) const;
  // q(T) from p0; false when the flow fails.
  [[nodiscard]] bool end_of(const StepPlan& plan, const Small& p0, Small& q) const;

  BoundaryValueProblem problem_;
  double tolerance_;
  bool ready_ = false;
  Small p0_;
  Small end_;                      // q(T) from p0
  SmallMatrix jacobian_;           // dq(T)/dp0,
  SmallMatrix inverse_;            // its inverse,
  std::vector<SmallMatrix> bend_;  // and its derivatives with respect to the p0_j
  StepPlan plan_;                  // of the flows,
  StepPlan check_;                 // and of the last
};

}  // namespace carnot
