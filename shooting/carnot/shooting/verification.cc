#include "carnot/shooting/verification.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "carnot/shooting/conjugate_times.h"
#include "carnot/shooting/multiple_shooting.h"

namespace carnot {
namespace {

constexpr int kPathIntervals = 32;
constexpr long kMaxSteps = 4096;

double largest_difference(const double* a, const double* b, int count) {
  double largest = 0;
  for (int j = 0; j < count; ++j) {
    const double difference = std::abs(a[j] - b[j]);
    largest = difference <= largest ? largest : difference;  // keeps a NaN
  }
  return largest;
}

// max-norm of flow(z_i) - z_{i+1} and, last, of q(T) - to. Infinite when a flow fails.
double knot_defect(const BoundaryValueProblem& problem, const Knots& knots, long steps) {
  const int n = knots.dof;
  double defect = 0;
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * n);
    const StepPlan plan = knot_plan(problem, knots.segments, i, steps);
    if (!problem.segment.flow(plan, z.data()).completed()) {
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
        return problem.segment.flow(plan, z.data()).completed();
      };
      settled = run(steps, coarse) && run(2 * steps, fine);
      const double allowed = std::max(kRoundOff * scale, 1e-3 * tolerance);
      settled = settled && largest_difference(coarse.data(), fine.data(), size) <= allowed;
    }
    if (settled) break;
  }
  return steps;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// How many directions of p0 do not move q(t), by the singular values of dq(t)/dp0. Where one run
// can be verified, 1e-10 is far above round-off and far below what regular problems show (1e-6).
int nullity(const Eigen::MatrixXd& x) {
  constexpr double kSingular = 1e-10;
  const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(x).singularValues();
  return static_cast<int>((values.array() <= kSingular * values[0]).count());
}

// dq(t)/dp0 along the extremal from p0; z(t) in `z`. Nothing when the flow fails.
std::optional<Eigen::MatrixXd> end_point_jacobian(const BoundaryValueProblem& problem,
                                                  const std::vector<double>& p0,
                                                  double t,
                                                  long steps,
                                                  std::vector<double>& z) {
  const int n = problem.segment.dof;
  RowMajor m(2 * n, 2 * n);
  z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  const StepPlan plan = StepPlan::equal(0, t, steps);
  if (!problem.segment.tangent_flow(plan, z.data(), m.data()).completed()) return std::nullopt;
  if (!m.allFinite()) return std::nullopt;
  return Eigen::MatrixXd(m.topRightCorner(n, n));
}

// Newton's method on q(T) = to, to the tolerance or as far as it goes; steps of least norm where
// the Jacobian is singular. Returns the end point error that p0 reaches, and the Jacobian there.
double correct(const BoundaryValueProblem& problem,
               long steps,
               double tolerance,
               std::vector<double>& p0,
               Eigen::MatrixXd& jacobian) {
  constexpr int kMaxIterations = 6;
  constexpr double kRankThreshold = 1e-13;
  const int n = problem.segment.dof;
  double best = std::numeric_limits<double>::infinity();
  std::vector<double> trial = p0;
  std::vector<double> z;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const auto at_trial = end_point_jacobian(problem, trial, problem.time, steps, z);
    if (!at_trial) break;
    const double error = largest_difference(z.data(), problem.to.data(), n);
    if (!(error < best)) break;
    const bool gained = error < 0.5 * best;
    best = error;
    p0 = trial;
    jacobian = *at_trial;
    if (!gained || error <= tolerance) break;
    Eigen::VectorXd residual(n);
    for (int j = 0; j < n; ++j) residual[j] = z[j] - problem.to[j];
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse;
    inverse.setThreshold(kRankThreshold);
    inverse.compute(jacobian);
    const Eigen::VectorXd step = inverse.solve(residual);
    for (int j = 0; j < n; ++j) trial[j] = p0[j] - step[j];
  }
  return best;
}

// Where directions of p0 do not move the end point, the member of least norm, if it is one: on an
// abnormal extremal any multiple of the abnormal covector may be added. Newton's steps have least
// norm themselves, so this changes nothing else.
void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& p0,
            Eigen::MatrixXd& jacobian) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
  const Eigen::MatrixXd kernel = svd.matrixV().rightCols(nullity(jacobian));
  const Eigen::Map<const Eigen::VectorXd> p(p0.data(), static_cast<Eigen::Index>(p0.size()));
  const Eigen::VectorXd least = p - kernel * (kernel.transpose() * p);
  std::vector<double> trial(least.data(), least.data() + least.size());
  Eigen::MatrixXd there = jacobian;
  if (!(correct(problem, steps, 1e-3 * tolerance, trial, there) <= tolerance)) return;
  p0 = trial;
  jacobian = there;
}

// Times of [0, T], `samples` in all, that belong to segment i: [t_i, t_{i+1}), the last one closed.
std::vector<double> times_of_segment(const BoundaryValueProblem& problem,
                                     int segments,
                                     int i,
                                     long samples) {
  const StepPlan whole = StepPlan::equal(0, problem.time, 1);
  std::vector<double> times;
  const double start = problem.time * i / segments;
  const double end = problem.time * (i + 1) / segments;
  const double slack = 1e-12 * problem.time;
  for (const double t : sample_times(whole, samples)) {
    const bool last = i + 1 == segments;
    if (t >= start - slack && (last || t < end - slack)) times.push_back(std::min(t, end));
  }
  return times;
}

void append(Trajectory& to, const Trajectory& from) {
  to.t.insert(to.t.end(), from.t.begin(), from.t.end());
  to.q.insert(to.q.end(), from.q.begin(), from.q.end());
  to.p.insert(to.p.end(), from.p.begin(), from.p.end());
  to.lambda.insert(to.lambda.end(), from.lambda.begin(), from.lambda.end());
  to.hamiltonian.insert(to.hamiltonian.end(), from.hamiltonian.begin(), from.hamiltonian.end());
}

// The measured flow over all segments.
FlowSummary survey(const BoundaryValueProblem& problem,
                   const Knots& knots,
                   long steps,
                   long samples) {
  FlowSummary total;
  double initial = 0;
  for (int i = 0; i < knots.segments; ++i) {
    std::vector<double> z(knots.at(i), knots.at(i) + 2 * knots.dof);
    AuditOptions options;
    options.times = times_of_segment(problem, knots.segments, i, samples);
    std::vector<double> unused(2 * knots.dof);
    const double energy =
        problem.segment
            .evaluate(0, z.data(), z.data() + knots.dof, unused.data(), unused.data() + knots.dof)
            .hamiltonian;
    if (i == 0) initial = energy;
    const FlowSummary part = problem.segment.audited_flow(
        knot_plan(problem, knots.segments, i, steps), z.data(), options);
    total.report = part.report;
    if (!part.completed()) return total;
    total.action += part.action;
    total.length += part.length;
    total.energy_drift =
        std::max(total.energy_drift, part.energy_drift + std::abs(energy - initial));
    total.constraint_error = std::max(total.constraint_error, part.constraint_error);
    append(total.trajectory, part.trajectory);
  }
  return total;
}

// The largest |value(q)| along the path: of samples, and of the parabola through the best three.
void add_extremes(const BoundaryValueProblem& problem,
                  const Knots& knots,
                  long steps,
                  Geodesic& geodesic) {
  if (problem.segment.info.extremes.empty()) return;
  const Trajectory fine = survey(problem, knots, steps, 2 * steps + 1).trajectory;
  for (const Extreme& extreme : problem.segment.info.extremes) {
    std::vector<double> size;
    for (const auto& q : fine.q) size.push_back(std::abs(extreme.value(q.data())));
    const auto top = std::max_element(size.begin(), size.end());
    double largest = *top;
    if (top != size.begin() && top + 1 != size.end()) {
      const double bend = top[-1] - 2 * top[0] + top[1];
      const double slope = 0.5 * (top[1] - top[-1]);
      if (bend < 0) largest -= 0.5 * slope * slope / bend;
    }
    geodesic.extremes.emplace_back(extreme.name, largest);
  }
}

// Abnormal: dq(t)/dp0 is singular already on the way. A family: it is singular at T only.
void classify_singular(const BoundaryValueProblem& problem, Geodesic& geodesic) {
  constexpr double kOnTheWay = 0.43;  // a time without symmetry
  std::vector<double> z;
  const long steps = geodesic.plan.count / 2;
  const auto way = end_point_jacobian(problem, geodesic.p0, kOnTheWay * problem.time, steps, z);
  const auto end = end_point_jacobian(problem, geodesic.p0, problem.time, steps, z);
  if (!way || !end) return;
  const int always = nullity(*way);
  geodesic.abnormal = always > 0;
  geodesic.family_dimension = std::max(0, nullity(*end) - always);
  if (*geodesic.family_dimension > 0) geodesic.label = Label::kSingular;
}

}  // namespace

std::optional<Extremal> verify(const BoundaryValueProblem& problem,
                               Knots knots,
                               long steps,
                               double tolerance) {
  steps = enough_steps(problem, knots, steps, tolerance);
  const long tighter = 2 * steps;
  Extremal extremal;
  Geodesic& geodesic = extremal.geodesic;
  std::vector<double> p0 = knots.p0();
  Eigen::MatrixXd jacobian;
  double error = std::numeric_limits<double>::infinity();
  if (correct(problem, steps, 1e-3 * tolerance, p0, jacobian) <= tolerance) {
    extremal.singular = nullity(jacobian) > 0;
    if (extremal.singular) reduce(problem, steps, tolerance, p0, jacobian);
    extremal.knots = knots_of(problem, p0, 1, tighter);
    error = largest_difference(extremal.knots.at(1), problem.to.data(), problem.segment.dof);
  }
  if (error <= tolerance) {
    geodesic.verification = Verification::kSingle;
    geodesic.endpoint_error = error;
  } else {
    extremal.singular = false;
    ShootingOptions options;
    options.steps = steps;
    options.tolerance = 1e-14;  // as far as it goes
    (void)shoot(problem, options, knots);
    extremal.knots = knots;
    geodesic.verification = Verification::kKnots;
    geodesic.knot_defect = knot_defect(problem, knots, tighter);
    if (!(geodesic.knot_defect <= tolerance)) return std::nullopt;
  }
  const FlowSummary measured = survey(problem, extremal.knots, tighter, kPathIntervals + 1);
  if (!measured.completed()) return std::nullopt;
  const int n = problem.segment.dof;
  std::vector<double> velocity(n);
  std::vector<double> lambda(problem.segment.multipliers + 1);
  geodesic.p0 = extremal.knots.p0();
  problem.segment.evaluate(
      0, problem.from.data(), geodesic.p0.data(), velocity.data(), lambda.data());
  lambda.pop_back();
  geodesic.lambda0 = lambda;
  geodesic.action = measured.action;
  geodesic.length = measured.length;
  geodesic.constraint_error = measured.constraint_error;
  geodesic.energy_drift = measured.energy_drift;
  geodesic.plan = StepPlan::equal(0, problem.time, tighter);
  extremal.path = measured.trajectory.q;
  return extremal;
}

bool same(const Extremal& a, const Extremal& b) {
  constexpr double kSame = 1e-6;
  const std::size_t n = a.path.front().size();
  for (std::size_t j = 0; j < n; ++j) {
    double extent = 0;
    double apart = 0;
    for (std::size_t i = 0; i < a.path.size(); ++i) {
      extent = std::max(extent, std::abs(a.path[i][j] - a.path[0][j]));
      apart = std::max(apart, std::abs(a.path[i][j] - b.path[i][j]));
    }
    // A coordinate that hardly moves has no scale of its own.
    if (apart > kSame * std::max(extent, kSame)) return false;
  }
  return true;
}

void complete(const BoundaryValueProblem& problem, long samples, Extremal& extremal) {
  Geodesic& geodesic = extremal.geodesic;
  const long steps = geodesic.plan.count;
  add_extremes(problem, extremal.knots, steps, geodesic);
  if (samples > 0) geodesic.trajectory = survey(problem, extremal.knots, steps, samples).trajectory;
  if (geodesic.verification == Verification::kSingle) classify_singular(problem, geodesic);
  if (geodesic.abnormal.value_or(false)) return;  // dq/dp0 is singular at all times
  const ConjugateTimes conjugate = conjugate_times(problem, extremal.knots, steps / 2);
  if (!conjugate.known) return;
  geodesic.conjugate_times = conjugate.times;
  const auto inner = std::count_if(
      conjugate.times.begin(), conjugate.times.end(), [&](double t) { return t < problem.time; });
  geodesic.morse_index = static_cast<int>(inner);
  if (geodesic.label == Label::kSingular) return;
  if (inner > 0) geodesic.label = Label::kConjugatePassed;
  if (conjugate.times.empty()) geodesic.label = Label::kLocallyMinimal;
}

bool same_family(const Extremal& a, const Extremal& b) {
  constexpr double kSameAction = 1e-9;
  const double apart = std::abs(a.geodesic.action - b.geodesic.action);
  return a.singular && b.singular && apart <= kSameAction * std::abs(a.geodesic.action);
}

}  // namespace carnot
