#include "carnot/shooting/shoot/end_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

double largest_difference(const double* a, const double* b, int count) {
  double largest = 0;
  for (int j = 0; j < count; ++j) {
    const double difference = std::abs(a[j] - b[j]);
    largest = difference <= largest ? largest : difference;  // a NaN stays
  }
  return largest;
}

std::optional<Eigen::MatrixXd> end_point_tangent(const BoundaryValueProblem& problem,
                                                 const std::vector<double>& p0,
                                                 double t,
                                                 long steps,
                                                 std::vector<double>& z) {
  const int n = problem.dynamics.dof;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n, 2 * n);
  z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  const StepPlan plan = StepPlan::equal(0, t, steps);
  if (!problem.dynamics.tangent_flow(plan, z, span_of(m)).completed()) return std::nullopt;
  if (!m.allFinite()) return std::nullopt;
  return Eigen::MatrixXd(m.rightCols(n));
}

Eigen::MatrixXd kernel_of(const Units& units, const Eigen::MatrixXd& raw, double tolerance) {
  const auto n = raw.cols();
  const Eigen::MatrixXd tangent = units.tangent(raw);
  const double q_size = tangent.topRows(n).norm();
  const double p_size = tangent.bottomRows(n).norm();
  Eigen::MatrixXd columns = tangent;
  if (q_size > 0 && p_size > 0) columns.topRows(n) *= p_size / q_size;
  const QrFactors plane = qr_factors(columns);
  const RightSingular still = right_singular(plane.q.topRows(n));
  const auto nullity = (still.values.array() <= tolerance).count();
  if (nullity == 0) return {n, 0};
  return orthonormal(units.momenta(lu_solve(plane.r, still.vectors.rightCols(nullity))));
}

double correct(const BoundaryValueProblem& problem,
               long steps,
               double tolerance,
               std::vector<double>& p0,
               Eigen::MatrixXd& tangent,
               double rank) {
  constexpr int kMaxIterations = 6;
  constexpr double kCautious = 1e-5;  // rank, where a full step went too far along a weak direction
  const int n = problem.dynamics.dof;
  double best = std::numeric_limits<double>::infinity();
  bool cautious = false;
  Eigen::VectorXd residual(n);
  std::vector<double> trial = p0;
  std::vector<double> z;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const auto at_trial = end_point_tangent(problem, trial, problem.time, steps, z);
    const double error = at_trial ? largest_difference(z.data(), problem.to.data(), n)
                                  : std::numeric_limits<double>::infinity();
    if (error < best) {
      const bool gained = error < 0.5 * best;
      best = error;
      p0 = trial;
      tangent = *at_trial;
      if (!gained || error <= tolerance) break;
      for (int j = 0; j < n; ++j) residual[j] = z[j] - problem.to[j];
    } else {
      if (cautious || iteration == 0) break;
      cautious = true;
    }
    const Units units(problem, p0.data());
    const Eigen::VectorXd step =
        units.momenta(least_squares(units.tangent(tangent).topRows(n),
                                    units.displacement(residual),
                                    cautious ? std::max(rank, kCautious) : rank));
    for (int j = 0; j < n; ++j) trial[j] = p0[j] - step[j];
  }
  return best;
}

void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& p0,
            Eigen::MatrixXd& tangent) {
  constexpr double kGenerous = 1e-4;
  constexpr double kSamePath = 1e-4;  // of its extent, where it is at a time without symmetry
  constexpr double kOnTheWay = 0.43;
  const Eigen::MatrixXd kernel = kernel_of(Units(problem, p0.data()), tangent, kGenerous);
  if (kernel.cols() == 0) return;
  const Eigen::Map<const Eigen::VectorXd> p(p0.data(), static_cast<Eigen::Index>(p0.size()));
  const Eigen::VectorXd least = p - kernel * (kernel.transpose() * p);
  // A generous rank comes first: it leaves the kernel alone. Along the kernel the end hardly moves,
  // and Newton's method would go back along it.
  constexpr double kSlack = 100;
  std::vector<double> trial;
  Eigen::MatrixXd there;
  bool arrives = false;
  for (const double rank : {kGenerous, kRankRoundOff}) {
    if (arrives) break;
    trial.assign(least.data(), least.data() + least.size());
    there = tangent;
    arrives = correct(problem, steps, tolerance, trial, there, rank) <= kSlack * tolerance;
  }
  if (!arrives) return;
  const auto on_the_way = [&](const std::vector<double>& momentum) {
    std::vector<double> z = problem.from;
    z.insert(z.end(), momentum.begin(), momentum.end());
    const StepPlan plan = StepPlan::equal(0, kOnTheWay * problem.time, steps);
    (void)problem.dynamics.flow(plan, z);
    return z;
  };
  const std::vector<double> before = on_the_way(p0);
  const std::vector<double> after = on_the_way(trial);
  const int n = problem.dynamics.dof;
  const double extent = largest_difference(before.data(), problem.from.data(), n);
  if (!(largest_difference(before.data(), after.data(), n) <= kSamePath * extent)) return;
  p0 = trial;
  tangent = there;
}

}  // namespace carnot::internal
