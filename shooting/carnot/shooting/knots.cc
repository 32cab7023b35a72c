#include "carnot/shooting/knots.h"

#include <algorithm>

namespace carnot {

Knots knots_of(const Path& path, int segments) {
  const int n = path.dof;
  Knots knots{segments, n, {}};
  for (int i = 0; i <= segments; ++i) {
    const int node = i * path.intervals / segments;
    knots.z.insert(knots.z.end(), path.configuration(node), path.configuration(node) + n);
    knots.z.insert(knots.z.end(), path.momentum(node), path.momentum(node) + n);
  }
  return knots;
}

Knots knots_of(const BoundaryValueProblem& problem,
               const std::vector<double>& p0,
               int segments,
               long steps) {
  const int n = problem.segment.dof;
  Knots knots{segments, n, problem.from};
  knots.z.insert(knots.z.end(), p0.begin(), p0.end());
  std::vector<double> z = knots.z;
  for (int i = 0; i < segments; ++i) {
    const FlowReport report =
        problem.segment.flow(knot_plan(problem, segments, i, steps), z.data());
    if (!report.completed()) z.assign(knots.at(i), knots.at(i) + 2 * n);
    knots.z.insert(knots.z.end(), z.begin(), z.end());
  }
  return knots;
}

StepPlan knot_plan(const BoundaryValueProblem& problem, int segments, int i, long steps) {
  const double duration = problem.time / segments;
  return StepPlan::equal(i * duration, duration, std::max(1L, (steps + segments - 1) / segments));
}

}  // namespace carnot
