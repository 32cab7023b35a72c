#include "carnot/shooting/extremal/verification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "carnot/numerics/scalar.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/manifold.h"
#include "carnot/shooting/shoot/end_point.h"
#include "carnot/shooting/shoot/multiple_shooting.h"
#include "carnot/shooting/shoot/survey.h"

namespace carnot::internal {
namespace {

constexpr long kMaxSteps = 4096;
constexpr double kAsFarAsItGoes = 1e-14;  // no scaled jumps are smaller

// What round-off may add to the defect of knots, where tangent flows grow by so much.
double round_off(const Knots& knots, double growth) {
  constexpr double kRoundings = 10;  // a step's share that does not average out
  double largest = 0;
  for (const double x : knots.z) largest = std::max(largest, std::abs(x));
  return kRoundings * kEpsilon * largest * std::max(1.0, growth);
}

// Whether the flow from p0 magnifies round-off so much that it cannot tell where the path ends.
// Where it does not, gaps at the knots only hide that the path ends elsewhere.
bool magnifies(const BoundaryValueProblem& problem,
               const Knots& knots,
               long steps,
               double tolerance) {
  constexpr double kShare = 1e-2;  // of the tolerance
  std::vector<double> z;
  const auto tangent =
      end_point_tangent(problem, start_unknowns(problem, knots.at(0)), problem.time, steps, z);
  return !tangent || !(round_off(knots, tangent->norm()) < kShare * tolerance);
}

// max-norm of flow(z_i) - z_{i+1} and, last, of what misses the target. Infinite when a flow fails.
double knot_defect(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  const int n = knots.dof;
  const double unit = length_per_momentum(problem, knots.at(0) + n);
  double defect = 0;
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * n);
    const StepPlan plan = knot_plan(problem, knots.segments, i, steps);
    if (!problem.dynamics.flow(plan, z).completed()) {
      return std::numeric_limits<double>::infinity();
    }
    const bool last = i + 1 == knots.segments;
    defect = maximum(defect,
                     last ? miss(problem, z.data(), unit)
                          : largest_difference(z.data(), knots.at(i + 1), 2 * n));
  }
  return defect;
}

// The end of segment i with some steps, and with twice as many. Nothing where a flow fails.
struct Halved {
  std::vector<double> coarse;
  std::vector<double> fine;
};
std::optional<Halved> halved(const BoundaryValueProblem& problem,
                             const Knots& knots,
                             int i,
                             long steps) {
  const std::vector<double> start(knots.at(i), knots.at(i) + 2 * knots.dof);
  Halved ends{start, start};
  const auto run = [&](long count, std::vector<double>& z) {
    return problem.dynamics.flow(knot_plan(problem, knots.segments, i, count), z).completed();
  };
  if (!run(steps, ends.coarse) || !run(2 * steps, ends.fine)) return std::nullopt;
  return ends;
}

// The fewest steps, doubling from `steps`, for which halving the step changes no segment by more
// than round-off or a thousandth of the tolerance.
long enough_steps(const BoundaryValueProblem& problem,
                  const Knots& knots,
                  long steps,
                  double tolerance) {
  const int size = 2 * knots.dof;
  for (; steps < kMaxSteps; steps *= 2) {
    bool settled = true;
    for (int i = 0; i < knots.segments && settled; ++i) {
      double scale = 0;
      for (int j = 0; j < size; ++j) scale = std::max(scale, std::abs(knots.at(i)[j]));
      const double allowed = std::max(kFlowRoundOff * scale, 1e-3 * tolerance);
      const auto ends = halved(problem, knots, i, steps);
      settled = ends && largest_difference(ends->coarse.data(), ends->fine.data(), size) <= allowed;
    }
    if (settled) break;
  }
  return steps;
}

// By how much halving the step moves the configuration at the end of a segment; infinite where a
// flow fails.
double moved_by_halving(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  double moved = 0;
  for (int i = 0; i < knots.segments; ++i) {
    const auto ends = halved(problem, knots, i, steps);
    if (!ends) return std::numeric_limits<double>::infinity();
    moved = maximum(moved, largest_difference(ends->coarse.data(), ends->fine.data(), knots.dof));
  }
  return moved;
}

// Whether the method errs by more than is allowed with the most steps. Its error still falls with
// the step then, which round-off does not.
bool is_too_coarse(const BoundaryValueProblem& problem, const Knots& knots, double allowed) {
  const double moved = moved_by_halving(problem, knots, kMaxSteps);
  return moved > allowed && moved < 0.5 * moved_by_halving(problem, knots, kMaxSteps / 2);
}

// What is asked of an extremal.
struct Demand {
  double aim;      // of Newton's method, at the end
  double allowed;  // by the check, at the end or at a knot
};

Demand demand_of(const BoundaryValueProblem& problem, double tolerance) {
  constexpr double kFiner = 1e-3;  // the aim over the tolerance
  const double distance = distance_between_ends(problem);
  const double aim = kFiner * tolerance;
  return {distance > 0 ? aim * std::min(1.0, distance) : aim, allowed_error(problem, tolerance)};
}

// From the start alone. False where a flow of twice as many steps does not arrive.
bool check_single(const BoundaryValueProblem& problem,
                  const Demand& demand,
                  long steps,
                  std::vector<double> x,
                  Extremal& extremal) {
  Eigen::MatrixXd tangent;
  if (!(correct(problem, steps, demand.aim, x, tangent) <= demand.allowed)) return false;
  reduce(problem, steps, demand.aim, x, tangent);
  // Momenta along the rows of Dh move nothing where holonomic constraints need forces.
  const auto kernel = kernel_of(Units(problem, x), tangent).cols();
  if (problem.dynamics.forced > 0) (void)bring_to_manifold(problem, x);
  const Knots knots = knots_of(problem, x, 1, 2 * steps);
  const double unit = length_per_momentum(problem, knots.at(0) + knots.dof);
  if (!(miss(problem, knots.at(1), unit) <= demand.allowed)) return false;
  extremal.singular = kernel > problem.dynamics.forced;
  extremal.knots = knots;
  extremal.geodesic.verification = Verification::kSingle;
  extremal.geodesic.endpoint_error = endpoint_error(problem, knots.at(1));
  return true;
}

// From one knot to the next. Returns why that is not good enough, or kNone.
Reason check_knots(const BoundaryValueProblem& problem,
                   const Demand& demand,
                   long steps,
                   double tolerance,
                   const Stop& stop,
                   Knots knots,
                   Extremal& extremal) {
  ShootingOptions options;
  options.stop = stop;
  options.steps = steps;
  options.tolerance = kAsFarAsItGoes;
  const double growth = shoot(problem, options, knots).growth;
  const double defect = knot_defect(problem, knots, 2 * steps);
  extremal.knots = knots;
  extremal.geodesic.verification = Verification::kKnots;
  extremal.geodesic.knot_defect = defect;
  if (defect <= demand.allowed) {
    return magnifies(problem, knots, steps, tolerance) ? Reason::kNone : Reason::kNotVerified;
  }
  if (std::isinf(defect)) return Reason::kFlowFailed;
  return demand.allowed < round_off(knots, growth) ? Reason::kBeyondDouble : Reason::kNotVerified;
}

// What a flow of `steps` along the knots says of the extremal. False when it fails.
bool measure(const BoundaryValueProblem& problem, long steps, Extremal& extremal) {
  const FlowSummary measured = survey(problem, extremal.knots, steps, kPathIntervals + 1);
  if (!measured.completed()) return false;
  std::vector<double> velocity(problem.dynamics.dof);
  Geodesic& geodesic = extremal.geodesic;
  const Knots& knots = extremal.knots;
  geodesic.from.assign(knots.at(0), knots.at(0) + knots.dof);
  geodesic.to = problem.to;
  for (int j = 0; j < knots.dof; ++j) {
    if (problem.is_free_to(j)) geodesic.to[j] = knots.at(knots.segments)[j];
  }
  geodesic.transversality_error = transversality_error(problem, knots.at(knots.segments));
  geodesic.p0 = knots.p0();
  geodesic.lambda0.assign(problem.dynamics.multipliers, 0.0);
  problem.dynamics.evaluate(0, geodesic.from, geodesic.p0, velocity, geodesic.lambda0);
  geodesic.action = measured.action;
  if (std::isfinite(measured.length)) geodesic.length = measured.length;
  geodesic.constraint_error = measured.constraint_error;
  geodesic.energy_drift = measured.energy_drift;
  geodesic.plan = StepPlan::equal(0, problem.time, steps);
  extremal.path = measured.trajectory.q;
  return true;
}

}  // namespace

double allowed_error(const BoundaryValueProblem& problem, double tolerance) {
  constexpr double kPart = 1e-3;  // of the distance: a path that misses by more goes elsewhere
  const double distance = distance_between_ends(problem);
  return distance > 0 ? std::min(tolerance, kPart * distance) : tolerance;
}

Outcome verify(const BoundaryValueProblem& problem,
               Knots knots,
               long steps,
               double tolerance,
               const Stop& stop) {
  const Demand demand = demand_of(problem, tolerance);
  steps = enough_steps(problem, knots, steps, tolerance);
  Extremal extremal;
  if (!check_single(problem, demand, steps, start_unknowns(problem, knots.at(0)), extremal)) {
    if (stop.reached()) return {};
    Reason reason =
        check_knots(problem, demand, steps, tolerance, stop, std::move(knots), extremal);
    if (stop.reached()) return {};
    if (reason == Reason::kNotVerified && steps >= kMaxSteps &&
        is_too_coarse(problem, extremal.knots, demand.allowed)) {
      reason = Reason::kMethodTooCoarse;
    }
    if (reason != Reason::kNone) return {std::nullopt, reason};
  }
  if (!measure(problem, 2 * steps, extremal)) return {std::nullopt, Reason::kFlowFailed};
  return {std::move(extremal), Reason::kNone};
}

void measure_errors(const BoundaryValueProblem& problem, Extremal& extremal) {
  const Knots& knots = extremal.knots;
  Geodesic& geodesic = extremal.geodesic;
  if (geodesic.verification == Verification::kKnots) {
    geodesic.knot_defect = knot_defect(problem, knots, geodesic.plan.count);
    geodesic.transversality_error = transversality_error(problem, knots.at(knots.segments));
    return;
  }
  std::vector<double> z(knots.at(0), knots.at(0) + 2 * knots.dof);
  if (!problem.dynamics.flow(geodesic.plan, z).completed()) return;
  geodesic.endpoint_error = endpoint_error(problem, z.data());
  geodesic.transversality_error = transversality_error(problem, z.data());
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
  const double apart = std::abs(a.geodesic.action - b.geodesic.action);
  return a.singular && b.singular && apart <= kSameAction * std::abs(a.geodesic.action);
}

}  // namespace carnot::internal
