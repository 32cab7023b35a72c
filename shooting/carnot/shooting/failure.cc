#include "carnot/shooting/failure.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "carnot/shooting/conjugate_times.h"
#include "carnot/shooting/end_point.h"

namespace carnot {
namespace {

constexpr long kSteps = 256;  // of the flow from the momentum of a discrete extremal

std::string regularity(const BoundaryValueProblem& problem) {
  std::vector<double> velocity(problem.segment.dof);
  std::vector<double> lambda(problem.segment.multipliers + 1);
  const std::vector<double> zero(problem.segment.dof, 0.0);
  const PointValues at =
      problem.segment.evaluate(0, problem.to.data(), zero.data(), velocity.data(), lambda.data());
  return at.status == RateStatus::kOk ? "" : "; at the target: " + std::string(describe(at.status));
}

// What the flow from p0 says.
std::string end_point(const BoundaryValueProblem& problem, const std::vector<double>& p0) {
  std::ostringstream text;
  text.precision(2);
  const int n = problem.segment.dof;
  std::vector<double> z;
  const auto tangent = end_point_tangent(problem, p0, problem.time, kSteps, z);
  if (!tangent) return "the flow from its momentum cannot be integrated";
  const Eigen::VectorXd values =
      Eigen::JacobiSVD<Eigen::MatrixXd>(tangent->topRows(n)).singularValues();
  const auto rank = n - static_cast<int>(kernel_of(*tangent).cols());
  text << "the flow from its momentum ends " << largest_difference(z.data(), problem.to.data(), n)
       << " away, where dq(T)/dp(0) has rank " << rank << " of " << n << " and condition "
       << values[0] / values[n - 1];
  const ConjugateTimes conjugate =
      conjugate_times(problem, knots_of(problem, p0, 1, kSteps), kSteps / 4);
  if (conjugate.known) {
    if (conjugate.times.empty())
      text << ", before any conjugate time";
    else
      text << ", past a conjugate time at " << conjugate.times.front();
  }
  return text.str();
}

}  // namespace

std::string explain_failure(const BoundaryValueProblem& problem,
                            const Search& search,
                            const GeodesicOptions& options) {
  const std::string tried =
      std::to_string(search.starts()) + (search.starts() == 1 ? " start" : " starts") + " tried";
  if (!options.guess.empty()) {
    return "the guess did not lead to an extremal (" + end_point(problem, options.guess) +
           "): leave --guess out to search from paths";
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (const Extremal& longer : search.extremals(true)) {
    shortest = std::min(shortest, longer.geodesic.length.value_or(shortest));
  }
  if (std::isfinite(shortest)) {
    return "the shortest extremal found has the length " + std::to_string(shortest) +
           ": try a larger --max-length";
  }
  if (!problem.segment.has_transcription()) {
    return "no momentum led to an extremal (" + tried + regularity(problem) +
           "): try more --starts, another --seed, a --guess, or a target less far away";
  }
  const Path* nearest = search.nearest_discrete();
  if (nearest == nullptr) {
    std::ostringstream residual;
    residual.precision(2);
    residual << "best residual " << search.least_residual() << " of the momentum";
    const bool collapsed = std::isinf(search.least_residual());
    return "no path relaxed to a discrete extremal (" + tried + ", " +
           (collapsed ? "all collapsed to the straight line" : residual.str()) +
           regularity(problem) + "): try more --starts, another --seed, or a target less far away";
  }
  const std::vector<double> p0(nearest->momentum(0), nearest->momentum(0) + nearest->dof);
  return "discrete extremals were found but none could be verified (" + tried +
         "; of the one of "
         "least action, " +
         end_point(problem, p0) + regularity(problem) +
         "): try a larger --tolerance, more --starts or another --seed";
}

}  // namespace carnot
