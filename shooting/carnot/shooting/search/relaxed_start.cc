#include "carnot/shooting/search/relaxed_start.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/path/discrete_newton.h"

namespace carnot::internal {
namespace {

double largest_momentum(const Path& path) {
  double largest = std::numeric_limits<double>::min();
  for (const double p : path.p) largest = std::max(largest, std::abs(p));
  return largest;
}

}  // namespace

RelaxedStart relaxed(const BoundaryValueProblem& problem, const Start& start, int stiffness) {
  // A path may collapse to the straight line, which violates the constraints, or be on its way
  // there. A stiffer penalty holds it.
  constexpr double kCollapsed = 0.5;
  constexpr double kHeld = 0.02;
  constexpr int kAttempts = 3;
  constexpr double kStiffer = 8;
  RelaxationOptions relaxation = start.relaxation;
  RelaxedStart result;
  relaxation.penalty *= std::pow(kStiffer, stiffness);
  for (; result.stiffness < kAttempts; ++result.stiffness, relaxation.penalty *= kStiffer) {
    result.path = start.path;
    const double violation = relax(problem, relaxation, result.path).violation;
    if (!(violation < kCollapsed)) continue;
    Path path = result.path;
    const DiscreteNewton tightened = tighten(problem, {}, path);
    result.blocked = tightened.left_chart || skims_chart_end(problem.dynamics, path);
    result.found = tightened.converged && !result.blocked;
    result.relaxed = !result.blocked;
    result.residual = tightened.residual / largest_momentum(path);
    if (result.found) result.path = std::move(path);
    if (result.found || violation < kHeld || result.stiffness > 0) break;
  }
  return result;
}

RelaxedStart relaxed_start(const MassLadder& ladder,
                           const std::optional<NearTarget>& near,
                           const RelaxedStartOptions& options,
                           int i) {
  if (!near) {
    const int rung = ladder.rung_of(i, options.intervals);
    Start start = make_start(ladder.on(rung), options.seed, i, options.intervals);
    start.path.rung = rung;
    return relaxed(ladder.on(rung), start, options.stiffness);
  }
  const NearTarget::Way way = near->way(i);
  const BoundaryValueProblem easy = near->easy(way);
  const Start start = make_start(easy, options.seed, i, options.intervals);
  RelaxedStart result = relaxed(easy, start, options.stiffness);
  result.relaxed = false;
  if (result.found) result.found = near->shrink(way, result.path);
  return result;
}

}  // namespace carnot::internal
