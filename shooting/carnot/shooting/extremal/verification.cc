#include "carnot/shooting/extremal/verification.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/shooting/problem/manifold.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

constexpr int kPathIntervals = 32;
constexpr long kMaxSteps = 4096;

// What round-off may add to the defect of knots, where tangent flows grow by so much.
double round_off(const Knots& knots, double growth) {
  constexpr double kRoundings = 10;  // a step's share that does not average out
  double largest = 0;
  for (const double x : knots.z) largest = std::max(largest, std::abs(x));
  return kRoundings * std::numeric_limits<double>::epsilon() * largest * std::max(1.0, growth);
}

// Whether the flow from p0 magnifies round-off so much that it cannot tell where the path ends.
// Where it does not, gaps at the knots only hide that the path ends elsewhere.
bool magnifies(const BoundaryValueProblem& problem,
               const Knots& knots,
               long steps,
               double tolerance) {
  constexpr double kShare = 1e-2;  // of the tolerance
  std::vector<double> z;
  const auto tangent = end_point_tangent(problem, knots.p0(), problem.time, steps, z);
  return !tangent || !(round_off(knots, tangent->norm()) < kShare * tolerance);
}

// max-norm of flow(z_i) - z_{i+1} and, last, of q(T) - to. Infinite when a flow fails.
double knot_defect(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  const int n = knots.dof;
  double defect = 0;
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * n);
    const StepPlan plan = knot_plan(problem, knots.segments, i, steps);
    if (!problem.dynamics.flow(plan, z.data()).completed()) {
      return std::numeric_limits<double>::infinity();
    }
    const bool last = i + 1 == knots.segments;
    defect = std::max(defect,
                      last ? largest_difference(z.data(), problem.to.data(), n)
                           : largest_difference(z.data(), knots.at(i + 1), 2 * n));
  }
  return defect;
}

// The fewest steps, doubling from `steps`, for which halving the step changes no segment by more
// than round-off or a hundredth of the tolerance.
long enough_steps(const BoundaryValueProblem& problem,
                  const Knots& knots,
                  long steps,
                  double tolerance) {
  constexpr double kRoundOff = 1e-13;
  const int size = 2 * knots.dof;
  for (; steps < kMaxSteps; steps *= 2) {
    bool settled = true;
    for (int i = 0; i < knots.segments && settled; ++i) {
      std::vector<double> coarse(knots.at(i), knots.at(i) + size);
      std::vector<double> fine = coarse;
      double scale = 0;
      for (const double x : coarse) scale = std::max(scale, std::abs(x));
      const auto run = [&](long count, std::vector<double>& z) {
        const StepPlan plan = knot_plan(problem, knots.segments, i, count);
        return problem.dynamics.flow(plan, z.data()).completed();
      };
      settled = run(steps, coarse) && run(2 * steps, fine);
      const double allowed = std::max(kRoundOff * scale, 1e-3 * tolerance);
      settled = settled && largest_difference(coarse.data(), fine.data(), size) <= allowed;
    }
    if (settled) break;
  }
  return steps;
}

}  // namespace

std::optional<Extremal> verify(const BoundaryValueProblem& problem,
                               Knots knots,
                               long steps,
                               double tolerance,
                               Reason* reason) {
  constexpr double kPart = 1e-3;  // of the distance: a path that misses by more goes elsewhere
  Reason unused = Reason::kNone;
  Reason& why = reason != nullptr ? *reason : unused;
  steps = enough_steps(problem, knots, steps, tolerance);
  const long tighter = 2 * steps;
  Extremal extremal;
  Geodesic& geodesic = extremal.geodesic;
  std::vector<double> p0 = knots.p0();
  Eigen::MatrixXd tangent;
  double error = std::numeric_limits<double>::infinity();
  // Near targets ask for digits relative to the distance.
  const double distance =
      largest_difference(problem.from.data(), problem.to.data(), problem.dynamics.dof);
  const double aim = 1e-3 * tolerance * (distance > 0 ? std::min(1.0, distance) : 1);
  const double allowed = distance > 0 ? std::min(tolerance, kPart * distance) : tolerance;
  if (correct(problem, steps, aim, p0, tangent) <= allowed) {
    // Holonomic constraints: p along the rows of Dh moves nothing.
    reduce(problem, steps, aim, p0, tangent);
    extremal.singular =
        kernel_of(Units(problem, p0.data()), tangent).cols() > problem.dynamics.forced;
    if (problem.dynamics.forced > 0) (void)bring_to_manifold(problem, p0);
    extremal.knots = knots_of(problem, p0, 1, tighter);
    error = largest_difference(extremal.knots.at(1), problem.to.data(), problem.dynamics.dof);
  }
  if (error <= allowed) {
    geodesic.verification = Verification::kSingle;
    geodesic.endpoint_error = error;
  } else {
    extremal.singular = false;
    ShootingOptions options;
    options.steps = steps;
    options.tolerance = 1e-14;  // as far as it goes
    const double growth = shoot(problem, options, knots).growth;
    extremal.knots = knots;
    geodesic.verification = Verification::kKnots;
    geodesic.knot_defect = knot_defect(problem, knots, tighter);
    if (geodesic.knot_defect <= allowed && !magnifies(problem, knots, steps, tolerance)) {
      why = Reason::kNotVerified;
      return std::nullopt;
    }
    if (!(geodesic.knot_defect <= allowed)) {
      why = std::isinf(geodesic.knot_defect)              ? Reason::kFlowFailed
            : allowed < round_off(extremal.knots, growth) ? Reason::kBeyondDouble
                                                          : Reason::kNotVerified;
      return std::nullopt;
    }
  }
  const FlowSummary measured = survey(problem, extremal.knots, tighter, kPathIntervals + 1);
  if (!measured.completed()) {
    why = Reason::kFlowFailed;
    return std::nullopt;
  }
  const int n = problem.dynamics.dof;
  std::vector<double> velocity(n);
  std::vector<double> lambda(problem.dynamics.multipliers + 1);
  geodesic.p0 = extremal.knots.p0();
  problem.dynamics.evaluate(
      0, problem.from.data(), geodesic.p0.data(), velocity.data(), lambda.data());
  lambda.pop_back();
  geodesic.lambda0 = lambda;
  geodesic.action = measured.action;
  if (std::isfinite(measured.length)) geodesic.length = measured.length;
  geodesic.constraint_error = measured.constraint_error;
  geodesic.energy_drift = measured.energy_drift;
  geodesic.plan = StepPlan::equal(0, problem.time, tighter);
  extremal.path = measured.trajectory.q;
  return extremal;
}

bool same(const Extremal& a, const Extremal& b) {
  constexpr double kSame = 1e-6;
  constexpr double kHardly = 1e-4;  // of the largest extent
  const std::size_t n = a.path.front().size();
  std::vector<double> extent(n, 0.0);
  std::vector<double> apart(n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < a.path.size(); ++i) {
      extent[j] = std::max(extent[j], std::abs(a.path[i][j] - a.path[0][j]));
      apart[j] = std::max(apart[j], std::abs(a.path[i][j] - b.path[i][j]));
    }
  }
  // A coordinate that hardly moves has no scale of its own.
  const double least = std::max(kSame, kHardly * *std::max_element(extent.begin(), extent.end()));
  for (std::size_t j = 0; j < n; ++j) {
    if (apart[j] > kSame * std::max(extent[j], least)) return false;
  }
  return true;
}

bool same_family(const Extremal& a, const Extremal& b) {
  constexpr double kSameAction = 1e-9;
  const double apart = std::abs(a.geodesic.action - b.geodesic.action);
  return a.singular && b.singular && apart <= kSameAction * std::abs(a.geodesic.action);
}

}  // namespace carnot::internal
