#include "carnot/shooting/shoot/knots.h"

#include <algorithm>

#include "carnot/shooting/problem/ends.h"

namespace carnot::internal {

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
               const std::vector<double>& x,
               int segments,
               long steps) {
  const int n = problem.dynamics.dof;
  Knots knots{segments, n, phase_point(problem, x)};
  std::vector<double> z = knots.z;
  for (int i = 0; i < segments; ++i) {
    const FlowReport report = problem.dynamics.flow(knot_plan(problem, segments, i, steps), z);
    if (!report.completed()) z.assign(knots.at(i), knots.at(i) + 2 * n);
    knots.z.insert(knots.z.end(), z.begin(), z.end());
  }
  return knots;
}

Knots knots_of(const Trajectory& samples, int segments) {
  Knots knots{segments, static_cast<int>(samples.q.front().size()), {}};
  const std::size_t stride = (samples.t.size() - 1) / segments;
  for (std::size_t i = 0; i < samples.t.size(); i += stride) {
    knots.z.insert(knots.z.end(), samples.q[i].begin(), samples.q[i].end());
    knots.z.insert(knots.z.end(), samples.p[i].begin(), samples.p[i].end());
  }
  return knots;
}

StepPlan knot_plan(const BoundaryValueProblem& problem, int segments, int i, long steps) {
  const double duration = problem.time / segments;
  return StepPlan::equal(i * duration, duration, std::max(1L, (steps + segments - 1) / segments));
}

}  // namespace carnot::internal
