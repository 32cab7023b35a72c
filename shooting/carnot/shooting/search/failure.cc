#include "carnot/shooting/search/failure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "carnot/shooting/extremal/conjugate_times.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/dilation.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/shoot/end_point.h"

namespace carnot::internal {
namespace {

constexpr long kSteps = 256;  // of the flow from the momentum of a discrete extremal

std::string regularity(const BoundaryValueProblem& problem) {
  std::vector<double> velocity(problem.dynamics.dof);
  std::vector<double> lambda(problem.dynamics.multipliers);
  const std::vector<double> zero(problem.dynamics.dof, 0.0);
  const PointValues at = problem.dynamics.evaluate(0, problem.to, zero, velocity, lambda);
  return at.status == RateStatus::kOk ? "" : "; at the target: " + std::string(describe(at.status));
}

std::string text_of(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

// What the flow from the unknowns x of the start says.
struct EndPoint {
  std::string text;
  bool beyond_double = false;  // dq(T)/dp0 is so ill-conditioned that p0 has no digit
};

EndPoint end_point(const BoundaryValueProblem& problem,
                   const NaturalScales& scales,
                   const std::vector<double>& x) {
  std::ostringstream text;
  text.precision(2);
  const int n = problem.dynamics.dof;
  std::vector<double> z;
  const auto tangent = end_point_tangent(problem, x, problem.time, kSteps, z);
  if (!tangent) return {"the flow from its momentum cannot be integrated"};
  const Eigen::VectorXd values = singular_values(tangent->topRows(n));
  const auto rank = n - static_cast<int>(kernel_of(Units(problem, x), *tangent).cols());
  const double condition = values[0] / values[n - 1];
  double away = 0;
  for (int j = 0; j < n; ++j) {
    if (!problem.is_free_to(j)) {
      away = std::max(away, scales.q[j] * std::abs(z[j] - problem.to[j]));
    }
  }
  text << "the flow from its momentum ends " << away << " away, where dq(T)/dp(0) has rank " << rank
       << " of " << n << " and condition " << condition;
  const ConjugateTimes conjugate =
      conjugate_times(problem, knots_of(problem, x, 1, kSteps), kSteps / 4);
  if (conjugate.known) {
    if (conjugate.times.empty())
      text << ", before any conjugate time";
    else
      text << ", past a conjugate time at " << scales.time * conjugate.times.front();
  }
  return {text.str(), rank == n && !(condition * kEpsilon < 1)};
}

// The length of the shortest extremal that was found but is too long; infinite where there is none.
double shortest_length(const Search& search) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const Extremal& longer : search.extremals(true)) {
    shortest = std::min(shortest, longer.geodesic.length.value_or(shortest));
  }
  return shortest;
}

// What became of the discrete extremals, where none is verified.
std::string fate(Reason furthest) {
  switch (furthest) {
    case Reason::kNotRefined:
      return "discrete extremals were found but have no counterpart on finer grids";
    case Reason::kFlowFailed:
      return "discrete extremals were found but the flow along them cannot be integrated";
    case Reason::kNotJoined:
      return "discrete extremals were found but shooting from them did not converge";
    case Reason::kBeyondDouble:
      return "discrete extremals were found but none that double precision can verify";
    case Reason::kMethodTooCoarse:
      return "extremals were found but the method errs by more than the tolerance, even in "
             "thousands of steps";
    default:
      return "discrete extremals were found but none could be verified";
  }
}

bool parted(const BoundaryValueProblem& problem) {
  return !same_chart(problem.dynamics, problem.from.data(), problem.to.data());
}

// What was tried, in words.
std::string effort(const BoundaryValueProblem& problem, const Search& search) {
  std::string tried =
      std::to_string(search.starts()) + (search.starts() == 1 ? " start" : " starts") + " tried";
  if (search.blocked() > 0) {
    tried += ", of which " + std::to_string(search.blocked()) +
             " ran into a singularity of the coordinates";
  }
  if (parted(problem)) tried += ", between ends that a singularity of the coordinates parts";
  return tried;
}

// Whether the coordinates stand in the way, and what helps then.
bool in_the_way(const BoundaryValueProblem& problem, const Search& search) {
  return parted(problem) || 2 * search.blocked() > search.starts();
}
constexpr const char* kMoreTolerance = "try a larger --tolerance, more --starts or another --seed";
constexpr const char* kMoreOrder =
    "try a --method of higher order, such as gauss16, or a larger --tolerance";
constexpr const char* kMoreMass =
    "try more mass for the lightest coordinate, more --starts or another --seed";
constexpr const char* kOtherCoordinates =
    "try more --starts, ends further from it, or other coordinates, such as a unit quaternion";

// Constraints that can be integrated keep a quantity, and lead to no target where it has another
// value. What tells of that; empty where nothing does.
std::string kept_quantity(const BoundaryValueProblem& problem, const NaturalScales& scales) {
  constexpr double kDifferences = 2e-3;  // brackets are differences
  const int n = problem.dynamics.dof;
  if (!problem.dynamics.has_transcription()) return "";
  BoundaryValueProblem back = problem;
  std::swap(back.from, back.to);
  const BracketSpan span = bracket_span(problem);
  if (span.dimension == n || bracket_span(back).dimension == n) return "";
  std::ostringstream text;
  text.precision(3);
  text << "at both ends the admissible velocities and their brackets of up to four span no more "
          "than "
       << span.dimension << " of " << n << " directions, so that the constraints seem to keep ";
  if (!span.annihilator) {
    text << n - span.dimension << " quantities";
  } else {
    std::vector<double> slopes(n);
    for (int j = 0; j < n; ++j) slopes[j] = (*span.annihilator)[j] / scales.q[j];
    const double largest = *std::max_element(
        slopes.begin(), slopes.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    text << "a quantity with the derivatives ";
    for (int j = 0; j < n; ++j) {
      const double slope = slopes[j] / largest;
      text << (j == 0 ? '(' : ' ') << (std::abs(slope) < kDifferences ? 0 : slope)
           << (j + 1 < n ? ',' : ')');
    }
    text << " at the start";
  }
  text << ", and no target with another value can be reached";
  return text.str();
}

Failure no_discrete(const BoundaryValueProblem& problem,
                    const NaturalScales& scales,
                    const Search& search) {
  const std::string none = "no path relaxed to a discrete extremal (" + effort(problem, search);
  if (in_the_way(problem, search)) {
    return {Reason::kSingularCoordinates,
            none + "): there may be no geodesic that keeps clear of it; " + kOtherCoordinates};
  }
  std::ostringstream residual;
  residual.precision(2);
  residual << "best residual " << search.least_residual() << " of the momentum";
  const bool collapsed = std::isinf(search.least_residual());
  const std::string kept = kept_quantity(problem, scales);
  return {
      Reason::kNoStartConverged,
      none + ", " + (collapsed ? "all collapsed to the straight line" : residual.str()) +
          regularity(problem) + "): " +
          (kept.empty() ? "try more --starts, another --seed, or a target less far away" : kept)};
}

}  // namespace

std::string blocked_starts(int blocked, int starts) {
  return std::to_string(blocked) + " of " + std::to_string(starts) +
         " starts ran into a singularity of the coordinates: there may be less action beyond it, "
         "in "
         "other coordinates";
}

Failure only_abnormal(double length) {
  return {Reason::kOnlyAbnormal,
          "the shortest path that was found, of length " + text_of(length) +
              ", is strictly abnormal: no momentum leads along it; a target beside it may have a "
              "geodesic with one"};
}

std::string least_is_abnormal() {
  return "the first is strictly abnormal: the constraints alone make it an extremal, and no "
         "momentum leads along it";
}

Failure explain_failure(const BoundaryValueProblem& problem,
                        const NaturalScales& scales,
                        const Search& search,
                        const GeodesicOptions& options) {
  const std::string tried = effort(problem, search);
  const bool joined = search.furthest() >= Reason::kNotVerified;
  const double shortest = shortest_length(search);
  if (std::isfinite(shortest)) {
    return {Reason::kTooLong,
            "the shortest extremal found has the length " + text_of(shortest * scales.length()) +
                ": try a larger --max-length"};
  }
  if (search.furthest() == Reason::kMethodTooCoarse) {
    return {search.furthest(), fate(search.furthest()) + " (" + tried + "): " + kMoreOrder};
  }
  if (!options.guess.empty()) {
    return {joined ? search.furthest() : Reason::kGuessFailed,
            "the guess did not lead to an extremal (" +
                end_point(problem, scales, options.guess).text +
                "): leave --guess out to search from paths"};
  }
  if (problem.dynamics.forced > 0) {
    return {joined ? search.furthest() : Reason::kNoStartConverged,
            "no momentum led to an extremal (" + tried + regularity(problem) +
                "): try more --starts, another --seed, a --guess, or a target less far away"};
  }
  const Path* nearest = search.nearest_discrete();
  if (nearest == nullptr) return no_discrete(problem, scales, search);
  if (nearest->rung > 0) {
    return {search.furthest(),
            "discrete extremals were found where light coordinates were given more mass, but none "
            "when it was taken away again (" +
                tried + regularity(problem) + "): " + kMoreMass};
  }
  const Knots knots = knots_of(*nearest, 1);
  const EndPoint end = end_point(problem, scales, start_unknowns(problem, knots.at(0)));
  const bool beyond = !joined && end.beyond_double;
  const Reason reason = beyond ? Reason::kBeyondDouble : search.furthest();
  // Along a path the momenta of light coordinates grow at a rate of 1/sqrt(mass), and lose digits.
  const char* advice = in_the_way(problem, search) ? kOtherCoordinates
                       : search.has_light_masses() ? kMoreMass
                                                   : kMoreTolerance;
  return {reason,
          fate(reason) + " (" + tried + "; of the one of least action, " + end.text +
              regularity(problem) + "): " + advice};
}

}  // namespace carnot::internal
