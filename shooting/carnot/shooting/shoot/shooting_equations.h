// The equations of multiple shooting, segment by segment, for any minimiser.
//
// Unknowns are those of the start (ends.h: p(0) where no end is free) and the phase points at the
// inner knots; segment i asks for flow(z_i) = z_{i+1}, the last one for q(T) = to, or p(T) = 0
// where the target is free. Jacobians are tangent flows, exact for the discrete map. Residuals are
// divided by the size of q, or p, along the path; or each momentum by its own size, for that of a
// light coordinate is small.
#pragma once

#include <vector>

#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/stop.h"
#include "carnot/shooting/shoot/knots.h"
#include "carnot/shooting/shoot/multiple_shooting.h"

namespace carnot::internal {

class ShootingEquations {
 public:
  // Of the options it takes the steps, the scales and what stops it. Keeps a reference to
  // `problem`.
  ShootingEquations(const BoundaryValueProblem& problem,
                    const Knots& knots,
                    const ShootingOptions& options);

  [[nodiscard]] int segments() const { return segments_; }
  [[nodiscard]] int dof() const { return dof_; }
  // Residuals of segment i: 2n, or n for the last one.
  [[nodiscard]] int residuals(int i) const { return i + 1 == segments_ ? dof_ : 2 * dof_; }

  // Residual of segment i between z (2n) and next (2n, unused for the last segment), and its
  // Jacobian with respect to z, residuals(i) x 2n row-major, unless null. The derivative with
  // respect to `next` is -1 / scale(row) on the diagonal. Returns false when the flow fails, or
  // when it is stopped.
  [[nodiscard]] bool evaluate(
      int i, const double* z, const double* next, double* residual, double* jacobian) const;

  // The largest derivative by an unknown in a Jacobian of segment i, in units of both scales.
  [[nodiscard]] double growth(int i, const double* jacobian) const;

  [[nodiscard]] bool stopped() const { return stop_.reached(); }

  [[nodiscard]] double scale(int row) const { return scale_[row]; }

  // Number of unknowns, and where unknown c stands in Knots::z.
  [[nodiscard]] int unknowns() const { return (2 * segments_ - 1) * dof_; }
  [[nodiscard]] int place(int c) const { return c < dof_ ? start_index(problem_, c) : dof_ + c; }
  [[nodiscard]] double unit(int c) const { return scale_[place(c) % (2 * dof_)]; }
  // Which number of a phase point row `row` of segment i is about.
  [[nodiscard]] int component(int i, int row) const {
    return i + 1 == segments_ ? target_index(problem_, row) : row;
  }

  // Replaces the last row of the knots by the last segment's flow.
  [[nodiscard]] bool complete(Knots& knots) const;

 private:
  const BoundaryValueProblem& problem_;
  int segments_;
  int dof_;
  long steps_;
  Stop stop_;
  std::vector<double> scale_;
};

}  // namespace carnot::internal
