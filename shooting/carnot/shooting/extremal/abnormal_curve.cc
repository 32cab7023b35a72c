#include "carnot/shooting/extremal/abnormal_curve.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "carnot/shooting/extremal/classification.h"
#include "carnot/shooting/extremal/singular_field.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/illinois.h"
#include "carnot/shooting/linear/round_off.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/tableau/dop853_tableau.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr long kFinestSteps = 4096;  // over a curve

VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}
std::vector<double> entries_of(const VectorXd& x) { return {x.data(), x.data() + x.size()}; }

// A curve on its way: columns q and p and, where a momentum is asked for, what drives it.
class Traveller {
 public:
  Traveller(const BoundaryValueProblem& problem, double sign)
      : field_(problem.dynamics), tableau_(dop853_tableau<double>()), sign_(sign) {}

  [[nodiscard]] std::optional<VectorXd> velocity(const MatrixXd& state) {
    const auto rate = field_.rate(state.col(0), state.col(1));
    if (!rate) return std::nullopt;
    return sign_ * rate->velocity;
  }
  // The derivative of the columns of a state; nothing where the curve is not told.
  [[nodiscard]] std::optional<MatrixXd> rate(const MatrixXd& state) {
    const auto along = field_.rate(state.col(0), state.col(1));
    if (!along) return std::nullopt;
    MatrixXd rate(state.rows(), state.cols());
    rate.col(0) = sign_ * along->velocity;
    rate.col(1) = sign_ * along->force;
    if (state.cols() > 2) {
      const MatrixXd columns = state.rightCols(state.cols() - 2);
      rate.rightCols(columns.cols()) = field_.drive(state.col(0), rate.col(0), columns).force;
    }
    return rate;
  }
  [[nodiscard]] SingularField& field() { return field_; }

  // One step of length h of the explicit method of order 8. False where the curve is not told; then
  // the state is unchanged.
  [[nodiscard]] bool step(double h, MatrixXd& state) {
    std::vector<MatrixXd> increments;
    for (int i = 0; i < tableau_.stages(); ++i) {
      MatrixXd stage = state;
      for (int j = 0; j < i; ++j) stage += tableau_.mu(i, j) * increments[j];
      const auto slope = rate(stage);
      if (!slope) return false;
      increments.emplace_back(h * tableau_.omega[i] * *slope);
    }
    for (int i = 0; i < tableau_.stages(); ++i) state += tableau_.update[i] * increments[i];
    return true;
  }
  // The same of the classical method of order 4, from the rate at the state. It takes a third of
  // the time, and is exact enough to see whether a curve comes by: after 56 steps of an eighth
  // along 200 curves of the Engel group the error is 6.5e-5 in the median and 4e-4 at most.
  [[nodiscard]] bool step_roughly(double h, const MatrixXd& first, MatrixXd& state) {
    const auto second = rate(state + 0.5 * h * first);
    const auto third = second ? rate(state + 0.5 * h * *second) : std::nullopt;
    const auto fourth = third ? rate(state + h * *third) : std::nullopt;
    if (!fourth) return false;
    state += h / 6 * (first + 2 * (*second + *third) + *fourth);
    return true;
  }
  [[nodiscard]] bool run(double length, long steps, MatrixXd& state) {
    for (long i = 0; i < steps; ++i) {
      if (!step(length / static_cast<double>(steps), state)) return false;
    }
    return true;
  }

 private:
  SingularField field_;
  Tableau<double> tableau_;
  double sign_;
};

MatrixXd start_of(const BoundaryValueProblem& problem, const std::vector<double>& covector) {
  MatrixXd state(problem.dynamics.dof, 2);
  state.col(0) = vector_of(problem.from);
  state.col(1) = vector_of(covector);
  return state;
}

// By how much q misses the target, and whether the curve comes nearer (negative) or goes away.
double miss_of(const BoundaryValueProblem& problem, const MatrixXd& state) {
  return endpoint_error(problem, state.col(0).data());
}
double approach(const BoundaryValueProblem& problem, const MatrixXd& state, const MatrixXd& rate) {
  return (state.col(0) - vector_of(problem.to)).dot(rate.col(0));
}

// Corrects the length of a curve that nearly arrives, in as many steps as its end needs. False
// where it does not arrive.
bool arrive(const BoundaryValueProblem& problem, double tolerance, AbnormalCurve& curve) {
  constexpr int kIterations = 8;
  Traveller traveller(problem, curve.sign);
  const VectorXd target = vector_of(problem.to);
  MatrixXd end;
  for (; curve.steps <= kFinestSteps; curve.steps *= 2) {
    double change = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kIterations && std::abs(change) > kFlowRoundOff * curve.length; ++i) {
      end = start_of(problem, curve.covector);
      if (!traveller.run(curve.length, curve.steps, end)) return false;
      const auto velocity = traveller.velocity(end);
      if (!velocity) return false;
      change = (target - end.col(0)).dot(*velocity) / velocity->squaredNorm();
      curve.length += change;
      if (!(curve.length > 0) || !std::isfinite(curve.length)) return false;
    }
    MatrixXd fine = start_of(problem, curve.covector);
    if (!traveller.run(curve.length, 2 * curve.steps, fine)) return false;
    const double scale = std::max(1.0, fine.col(0).cwiseAbs().maxCoeff());
    if ((fine.col(0) - end.col(0)).cwiseAbs().maxCoeff() > kFlowRoundOff * scale) continue;
    curve.endpoint_error = miss_of(problem, fine);
    return curve.endpoint_error <= allowed_error(problem, tolerance);
  }
  return false;
}

// How far curves are followed, and in which steps, in natural scales.
struct CurveLength {
  double longest;
  double step;
};

// Follows the curve until it arrives.
std::optional<AbnormalCurve> follow(const BoundaryValueProblem& problem,
                                    const CurveLength& reach,
                                    double tolerance,
                                    AbnormalCurve curve) {
  constexpr double kNear = 0.03;  // steps; a curve that misses by more does not arrive
  Traveller traveller(problem, curve.sign);
  MatrixXd state = start_of(problem, curve.covector);
  auto rate = traveller.rate(state);
  for (double length = 0; rate && length < reach.longest; length += reach.step) {
    const MatrixXd last = state;
    const MatrixXd last_rate = *rate;
    if (!traveller.step_roughly(reach.step, last_rate, state)) return std::nullopt;
    rate = traveller.rate(state);
    if (!rate) return std::nullopt;
    const double before = approach(problem, last, last_rate);
    const double after = approach(problem, state, *rate);
    if (!(before < 0 && after >= 0)) continue;
    MatrixXd nearest;
    const auto at = [&](double part) -> std::optional<double> {
      nearest = last;
      if (!traveller.step_roughly(part, last_rate, nearest)) return std::nullopt;
      const auto there = traveller.rate(nearest);
      if (!there) return std::nullopt;
      return approach(problem, nearest, *there);
    };
    const double part = illinois(0.0, before, reach.step, after, 1e-6 * reach.step, at);
    (void)at(part);
    curve.length = length + part;
    curve.steps = 1 + static_cast<long>(curve.length / reach.step);
    const bool near = miss_of(problem, nearest) <= kNear * reach.step;
    if (near && arrive(problem, tolerance, curve)) return curve;
  }
  return std::nullopt;
}

// Covectors to follow a curve of each: where there are many, random combinations. Those of a basis
// may be just the ones that tell no velocity, as in the flag of a car with trailers, where all
// others have one and the same curve.
MatrixXd combined(const MatrixXd& covectors) {
  constexpr int kDraws = 4;
  if (covectors.cols() <= 1) return covectors;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  MatrixXd weights(covectors.cols(), kDraws);
  for (Eigen::Index j = 0; j < kDraws; ++j) {
    for (Eigen::Index i = 0; i < weights.rows(); ++i) weights(i, j) = normal(random);
    weights.col(j).normalize();
  }
  return product(covectors, weights);
}

}  // namespace

bool may_have_abnormal_curves(const BoundaryValueProblem& problem) {
  if (problem.has_free_ends() || !problem.limits.empty()) return false;
  const VectorXd start = vector_of(problem.from);
  if (!SingularField::suits(problem.dynamics, start)) return false;
  return SingularField(problem.dynamics).covectors(start).cols() > 0;
}

std::optional<AbnormalCurve> abnormal_curve(const BoundaryValueProblem& problem,
                                            double longest,
                                            double tolerance) {
  // Steps as long as the curve bends, which is in natural scales, or as the ends are apart: a curve
  // is followed for at least four times their distance.
  constexpr double kStep = 1.0 / 8;
  constexpr double kPart = 1.0 / 32;
  constexpr int kMostSteps = 128;
  const VectorXd start = vector_of(problem.from);
  const double distance = (vector_of(problem.to) - start).norm();
  SingularField field(problem.dynamics);
  const MatrixXd covectors = combined(field.covectors(start));
  std::optional<AbnormalCurve> shortest;
  if (!(distance > 0)) return std::nullopt;
  CurveLength reach{longest, std::min(std::max(kStep, kPart * distance), 0.5 * distance)};
  reach.longest = std::min(longest, kMostSteps * reach.step);
  for (Eigen::Index j = 0; j < covectors.cols(); ++j) {
    for (const double sign : {1.0, -1.0}) {
      AbnormalCurve curve;
      curve.covector = entries_of(covectors.col(j));
      curve.sign = sign;
      auto found = follow(problem, reach, tolerance, std::move(curve));
      if (!found || found->length > reach.longest) continue;
      reach.longest = found->length;
      shortest = std::move(found);
    }
  }
  return shortest;
}

std::optional<std::vector<double>> normal_momentum(const BoundaryValueProblem& problem,
                                                   const AbnormalCurve& curve) {
  constexpr double kSolves = 1e-6;   // of the size of the momentum
  constexpr double kRegular = 1e-9;  // of least squares
  constexpr long kNodes = 32;
  Traveller traveller(problem, curve.sign);
  MatrixXd state = start_of(problem, curve.covector);
  const auto velocity = traveller.velocity(state);
  if (!velocity) return std::nullopt;
  const VectorXd own = traveller.field().momentum(state.col(0), *velocity);
  const MatrixXd free = traveller.field().annihilator(state.col(0));
  const auto count = free.cols();
  state.conservativeResize(Eigen::NoChange, 3 + count);
  state.col(2) = own;
  state.rightCols(count) = free;
  MatrixXd violations(2 * (kNodes + 1), 1 + count);
  const long steps = std::max(1L, curve.steps / kNodes);
  for (long i = 0; i <= kNodes; ++i) {
    const auto along = traveller.velocity(state);
    if (!along) return std::nullopt;
    violations.middleRows(2 * i, 2) =
        traveller.field().drive(state.col(0), *along, state.rightCols(1 + count)).violations;
    if (i < kNodes && !traveller.run(curve.length / kNodes, steps, state)) return std::nullopt;
  }
  const MatrixXd by_free = violations.rightCols(count);
  const VectorXd part = violations.col(0);
  if (!by_free.allFinite() || !part.allFinite()) return std::nullopt;
  const VectorXd added = least_squares(by_free, -part, kRegular);
  const VectorXd left = part + product(by_free, added).col(0);
  if (!(left.cwiseAbs().maxCoeff() <= kSolves * own.norm())) return std::nullopt;
  const VectorXd p0 = own + product(free, added).col(0);
  return entries_of(curve.length / problem.time * p0);
}

Extremal extremal_of(const BoundaryValueProblem& problem,
                     const AbnormalCurve& curve,
                     long samples) {
  Extremal extremal;
  Geodesic& geodesic = extremal.geodesic;
  const int n = problem.dynamics.dof;
  const int k = problem.dynamics.multipliers;
  geodesic.from = problem.from;
  geodesic.to = problem.to;
  geodesic.p0.assign(n, kNaN);
  geodesic.lambda0.assign(k, kNaN);
  geodesic.length = curve.length;
  geodesic.action = 0.5 * curve.length * curve.length / problem.time;
  geodesic.endpoint_error = curve.endpoint_error;
  geodesic.energy_drift = kNaN;
  geodesic.label = Label::kAbnormal;
  geodesic.abnormal = true;
  geodesic.plan = StepPlan::equal(0, problem.time, 2 * curve.steps);
  Traveller traveller(problem, curve.sign);
  // The configurations at so many equidistant times.
  const auto configurations = [&](long times) {
    MatrixXd state = start_of(problem, curve.covector);
    std::vector<std::vector<double>> nodes{problem.from};
    const long intervals = std::max(1L, times - 1);
    const double length = curve.length / static_cast<double>(intervals);
    for (long i = 0; i < intervals && times != 1; ++i) {
      if (!traveller.run(length, 1 + 2 * curve.steps / intervals, state)) break;
      nodes.push_back(entries_of(state.col(0)));
      const auto velocity = traveller.velocity(state);
      const double error = velocity ? traveller.field().violation(state.col(0), *velocity) : kNaN;
      geodesic.constraint_error = std::max(geodesic.constraint_error, error);
    }
    return nodes;
  };
  extremal.path = configurations(kPathIntervals + 1);
  set_extremes(problem, configurations(2 * geodesic.plan.count + 1), geodesic);
  if (samples > 0) {
    Trajectory& trajectory = geodesic.trajectory;
    trajectory.t = sample_times(StepPlan::equal(0, problem.time, 1), samples);
    trajectory.q = configurations(samples);
    if (samples == 1) trajectory.q = {extremal.path.back()};
    trajectory.p.assign(samples, geodesic.p0);
    trajectory.lambda.assign(samples, geodesic.lambda0);
    trajectory.hamiltonian.assign(samples, kNaN);
  }
  return extremal;
}

}  // namespace carnot::internal
