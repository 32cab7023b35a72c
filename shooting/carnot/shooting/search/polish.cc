#include "carnot/shooting/search/polish.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "carnot/shooting/path/refinement.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/multiple_shooting.h"

namespace carnot::internal {
namespace {

// At least; divides the intervals of a path. Ceres factors a dense matrix of 2n unknowns a segment.
// With 8 of them the median search takes 1.08 of the time for unicycle, 1.07 for vehicle and 1.06
// for sideways parking. Of 180 targets of twelve scenes, 60 of them up to 15 away, none gets
// another action.
constexpr int kSegments = 4;
constexpr long kFewSteps = 16;  // of the method over the whole time, at least

// Which of two failures came further is told by the order of Reason.
void come_to(Reason& furthest, Reason reason) { furthest = std::max(furthest, reason); }

RefinementOptions refinement_of(const Path& path, const Stop& stop) {
  constexpr int kDoublings = 8;  // of long ways, at least
  constexpr int kFeet = 4;       // times the first grid at the foot of the ladder, at least
  RefinementOptions refinement;
  refinement.stop = stop;
  refinement.enough = 4e-2;
  refinement.max_intervals = std::max(refinement.max_intervals, kDoublings * path.intervals);
  refinement.max_intervals =
      std::max(refinement.max_intervals, kFeet * path.intervals << path.rung);
  return refinement;
}

// Joins the knots on a refined path. Where a segment cannot be integrated, or magnifies too much
// for Newton's method to keep its digits, they are set closer together.
Outcome join(const BoundaryValueProblem& problem,
             const GeodesicOptions& options,
             const Refinement& refined,
             int patience,
             const Stop& stop) {
  constexpr double kMaxGrowth = 1e5;
  constexpr int kIntervalsPerSegment = 32;
  constexpr int kIntervalsPerStep = 8;
  // Where flows magnify too much at first, as along a light steering axle, Newton's method takes
  // more than a few iterations with shorter ones, and momenta need scales of their own. Of 25
  // random targets of a car (wheelbase 2.7, inertias of 0.05 and, of the steering, 0.002) 4 are not
  // solved with neither or with the iterations alone, 3 with these scales alone, and 1 with both,
  // in 1.2 times the time. If all joins begin with these scales, one least action of a bicycle is
  // missed.
  constexpr int kPatient = 30;
  ShootingOptions shooting;
  shooting.stop = stop;
  shooting.minimiser = options.minimiser;
  shooting.max_growth = kMaxGrowth;
  const bool local = options.minimiser == "newton" || options.minimiser == "ceres";
  if (local) shooting.max_iterations = patience;
  shooting.steps = std::max<long>(kFewSteps, refined.intervals / kIntervalsPerStep);
  Reason furthest = Reason::kNone;
  int segments = std::max(kSegments, refined.intervals / kIntervalsPerSegment);
  while (segments <= refined.path.intervals && !stop.reached()) {
    Knots knots = knots_of(refined.path, segments);
    const Shooting joined = shoot(problem, shooting, knots);
    if (joined.converged) {
      Outcome verified =
          verify(problem, std::move(knots), 2 * shooting.steps, options.tolerance, stop);
      if (!verified.extremal) come_to(verified.reason, furthest);
      return verified;
    }
    const bool begun = joined.iterations > 0 || joined.growth > 0;
    come_to(furthest, begun ? Reason::kNotJoined : Reason::kFlowFailed);
    if (begun && joined.growth <= kMaxGrowth) break;
    shooting.own_scales = begun;
    if (local && begun) shooting.max_iterations = kPatient;
    segments *= 2;
    shooting.steps = begun ? std::max<long>(shooting.steps, segments) : 2 * shooting.steps;
  }
  return {std::nullopt, furthest};
}

}  // namespace

Outcome shoot_along(const BoundaryValueProblem& problem,
                    const GeodesicOptions& options,
                    const Path& path) {
  const int n = path.dof;
  const double h = problem.time / path.intervals;
  std::vector<double> velocity(n);
  for (int j = 0; j < n; ++j) {
    velocity[j] = (path.configuration(1)[j] - path.configuration(0)[j]) / h;
  }
  std::vector<double> z(path.configuration(0), path.configuration(0) + n);
  z.resize(2 * n);
  const std::vector<double> lambda(problem.dynamics.multipliers, 0.0);
  const std::span<double> start(z);
  problem.dynamics.momentum(0, start.first(n), velocity, lambda, start.subspan(n));
  return shoot_from(problem, options, start_unknowns(problem, z.data()));
}

Outcome shoot_from(const BoundaryValueProblem& problem,
                   const GeodesicOptions& options,
                   std::vector<double> x) {
  constexpr double kPart = 1e-6;  // of the distance; near enough to be verified
  const double distance = distance_between_ends(problem);
  Eigen::MatrixXd tangent;
  if (!(correct(problem, kFewSteps, 0, x, tangent) <= kPart * distance)) {
    return {std::nullopt, Reason::kNotJoined};
  }
  return verify(problem, knots_of(problem, x, 1, kFewSteps), 2 * kFewSteps, options.tolerance);
}

Refinement refine_to_polish(const MassLadder& ladder, const Path& path, const Stop& stop) {
  return refine(ladder, refinement_of(path, stop), path);
}

Outcome polish(const MassLadder& ladder, const GeodesicOptions& options, const Path& path) {
  return polish(ladder, options, path, refine_to_polish(ladder, path));
}

Outcome polish(const MassLadder& ladder,
               const GeodesicOptions& options,
               const Path& path,
               const Refinement& refined,
               const Stop& stop) {
  // From a grid that is fine enough Newton's method takes two or three iterations. Where it takes
  // more a finer grid, which is cheaper than the flow, comes first.
  const BoundaryValueProblem& problem = ladder.on(0);
  constexpr std::array kPatience{4, 8, 12};
  RefinementOptions refinement = refinement_of(path, stop);
  Outcome outcome{std::nullopt, Reason::kNotRefined};
  Refinement further;
  for (const int patience : kPatience) {
    const bool first = patience == kPatience.front();
    if (!first) further = refine(ladder, refinement, path);
    const Refinement& grid = first ? refined : further;
    if (!grid.found || stop.reached()) break;
    Outcome joined = join(problem, options, grid, patience, stop);
    come_to(outcome.reason, joined.reason);
    outcome.extremal = std::move(joined.extremal);
    if (joined.reason == Reason::kMethodTooCoarse) return outcome;
    if (outcome.extremal || !grid.settled) break;
    refinement.enough = 0.2 * grid.change;
  }
  if (stop.reached() && !outcome.extremal) return {};
  // With large multipliers knots may join what needs none.
  if (!outcome.extremal || outcome.extremal->geodesic.verification == Verification::kKnots) {
    auto along = shoot_along(problem, options, path).extremal;
    if (along && (!outcome.extremal || same(*along, *outcome.extremal))) {
      outcome.extremal = std::move(along);
    }
  }
  if (outcome.extremal) outcome.reason = Reason::kNone;
  return outcome;
}

Outcome polish(const BoundaryValueProblem& problem,
               const GeodesicOptions& options,
               const Knots& knots,
               const Stop& stop) {
  ShootingOptions shooting;
  shooting.stop = stop;
  std::vector<std::string> ways{options.minimiser};
  if (ways.front() == "newton") ways.emplace_back("ceres");  // which reaches further
  Reason furthest = Reason::kNone;
  for (const std::string& way : ways) {
    for (const long steps : {kFewSteps, 4 * kFewSteps}) {
      Knots joined = knots;
      shooting.minimiser = way;
      shooting.near = way != "ceres";
      shooting.steps = steps;
      if (!shoot(problem, shooting, joined).converged) {
        come_to(furthest, Reason::kNotJoined);
        continue;
      }
      Outcome verified = verify(problem, std::move(joined), 2 * kFewSteps, options.tolerance, stop);
      if (verified.extremal || verified.reason == Reason::kMethodTooCoarse) return verified;
      come_to(furthest, verified.reason);
    }
  }
  if (stop.reached()) return {};
  return {std::nullopt, furthest};
}

}  // namespace carnot::internal
