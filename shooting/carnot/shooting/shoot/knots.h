// Phase points at equidistant shooting times, the unknowns of multiple shooting.
#pragma once

#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"

namespace carnot::internal {

// Knots i = 0..segments at times i T / segments. z is (segments + 1) x 2n, rows (q, p); the last
// row is what the last segment's flow gives, so q there is near `to` but is not set to it.
struct Knots {
  int segments = 0;
  int dof = 0;
  std::vector<double> z;

  [[nodiscard]] const double* at(int i) const { return z.data() + i * 2 * dof; }
  [[nodiscard]] double* at(int i) { return z.data() + i * 2 * dof; }
  [[nodiscard]] std::vector<double> p0() const { return {at(0) + dof, at(0) + 2 * dof}; }
};

// Every (intervals / segments)-th node of a relaxed path.
Knots knots_of(const Path& path, int segments);

// The extremal with the unknowns x of its start (ends.h; p(0) where no end is free), cut into
// segments; `steps` of the method in all. Where the flow fails the remaining knots repeat the last
// one.
Knots knots_of(const BoundaryValueProblem& problem,
               const std::vector<double>& x,
               int segments,
               long steps);

// Every so many-th sample of a recorded extremal; `segments` + 1 of them must be equidistant.
Knots knots_of(const Trajectory& samples, int segments);

// The plan of segment i when the whole time takes about `steps` steps.
StepPlan knot_plan(const BoundaryValueProblem& problem, int segments, int i, long steps);

}  // namespace carnot::internal
