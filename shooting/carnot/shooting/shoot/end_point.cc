#include "carnot/shooting/shoot/end_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/ends.h"

namespace carnot::internal {

double largest_difference(const double* a, const double* b, int count) {
  double largest = 0;
  for (int j = 0; j < count; ++j) {
    largest = maximum(largest, std::abs(a[j] - b[j]));
  }
  return largest;
}

std::optional<Eigen::MatrixXd> end_point_tangent(const BoundaryValueProblem& problem,
                                                 const std::vector<double>& x,
                                                 double t,
                                                 long steps,
                                                 std::vector<double>& z) {
  const int n = problem.dynamics.dof;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n, 2 * n);
  z = phase_point(problem, x);
  const StepPlan plan = StepPlan::equal(0, t, steps);
  if (!problem.dynamics.tangent_flow(plan, z, span_of(m)).completed()) return std::nullopt;
  if (!m.allFinite()) return std::nullopt;
  Eigen::MatrixXd tangent(2 * n, n);
  for (int j = 0; j < n; ++j) tangent.col(j) = m.col(start_index(problem, j));
  for (int j = 0; j < n; ++j) {
    if (!problem.is_free_to(j)) continue;
    tangent.row(j).swap(tangent.row(n + j));
    tangent.row(n + j) *= -1;
  }
  return tangent;
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
               std::vector<double>& x,
               Eigen::MatrixXd& tangent,
               double rank) {
  constexpr int kMaxIterations = 6;
  constexpr double kCautious = 1e-5;  // rank, where a full step went too far along a weak direction
  const int n = problem.dynamics.dof;
  double best = std::numeric_limits<double>::infinity();
  bool cautious = false;
  Eigen::VectorXd residual(n);
  std::vector<double> trial = x;
  std::vector<double> z = phase_point(problem, x);
  const double unit = length_per_momentum(problem, z.data() + n);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const auto at_trial = end_point_tangent(problem, trial, problem.time, steps, z);
    const double error =
        at_trial ? miss(problem, z.data(), unit) : std::numeric_limits<double>::infinity();
    if (error < best) {
      const bool gained = error < 0.5 * best;
      best = error;
      x = trial;
      tangent = *at_trial;
      if (!gained || error <= tolerance) break;
      for (int j = 0; j < n; ++j) {
        residual[j] = z[target_index(problem, j)] - target_value(problem, j);
      }
    } else {
      if (cautious || iteration == 0) break;
      cautious = true;
    }
    const Units units(problem, x);
    const Eigen::VectorXd step =
        units.momenta(least_squares(units.tangent(tangent).topRows(n),
                                    units.displacement(residual),
                                    cautious ? std::max(rank, kCautious) : rank));
    for (int j = 0; j < n; ++j) trial[j] = x[j] - step[j];
  }
  return best;
}

void approach(const BoundaryValueProblem& problem, long steps, std::vector<double>& x) {
  // Of 16 random momenta 10 to 12 arrive so (skate-on-sphere), and 0 to 4 by correct() alone.
  constexpr int kIterations = 8;
  constexpr double kLongest = 0.5;  // of the momenta
  constexpr double kShort = 0.1;    // of that
  const int n = problem.dynamics.dof;
  std::vector<double> z = phase_point(problem, x);
  Eigen::VectorXd residual(n);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const auto tangent = end_point_tangent(problem, x, problem.time, steps, z);
    if (!tangent) return;
    for (int j = 0; j < n; ++j) {
      residual[j] = z[target_index(problem, j)] - target_value(problem, j);
    }
    const Units units(problem, x);
    const Eigen::VectorXd step = units.momenta(least_squares(
        units.tangent(*tangent).topRows(n), units.displacement(residual), kRankRoundOff));
    const Eigen::Map<Eigen::VectorXd> momenta(x.data(), n);
    const double longest = kLongest * momenta.norm();
    const double size = step.norm();
    if (!std::isfinite(size)) return;
    Eigen::Map<Eigen::VectorXd>(x.data(), n) -= std::min(1.0, longest / size) * step;
    if (size < kShort * longest) return;
  }
}

void reduce(const BoundaryValueProblem& problem,
            long steps,
            double tolerance,
            std::vector<double>& x,
            Eigen::MatrixXd& tangent) {
  constexpr double kGenerous = 1e-4;
  constexpr double kSamePath = 1e-4;  // of its extent, where it is at a time without symmetry
  constexpr double kOnTheWay = 0.43;
  const Eigen::MatrixXd kernel = kernel_of(Units(problem, x), tangent, kGenerous);
  if (kernel.cols() == 0) return;
  const Eigen::Map<const Eigen::VectorXd> p(x.data(), static_cast<Eigen::Index>(x.size()));
  const Eigen::VectorXd without = p - kernel * (kernel.transpose() * p);
  const std::vector<double> least(without.data(), without.data() + without.size());
  const auto place = [&](const std::vector<double>& unknowns, double share) {
    std::vector<double> z = phase_point(problem, unknowns);
    const StepPlan plan = StepPlan::equal(0, share * problem.time, steps);
    (void)problem.dynamics.flow(plan, z);
    return z;
  };
  const int n = problem.dynamics.dof;
  const std::vector<double> before = place(x, kOnTheWay);
  const double extent = largest_difference(before.data(), problem.from.data(), n);
  // Momenta of a kernel hardly move the end. On a stiff path that is so to first order only, and
  // Newton's method would come back by long flows, if at all. Of 351 reductions in the tests all
  // 175 that arrived began nearer to the target than the start is, and 137 of the others did not.
  const double distance = distance_between_ends(problem);
  const std::vector<double> end = place(least, 1);
  const double unit = length_per_momentum(problem, end.data() + n);
  if (!(miss(problem, end.data(), unit) <= (distance > 0 ? distance : extent))) return;
  // A generous rank comes first: it leaves the kernel alone. Along the kernel the end hardly moves,
  // and Newton's method would go back along it.
  constexpr double kSlack = 100;
  std::vector<double> trial;
  Eigen::MatrixXd there;
  bool arrives = false;
  for (const double rank : {kGenerous, kRankRoundOff}) {
    if (arrives) break;
    trial = least;
    there = tangent;
    arrives = correct(problem, steps, tolerance, trial, there, rank) <= kSlack * tolerance;
  }
  if (!arrives) return;
  const std::vector<double> after = place(trial, kOnTheWay);
  if (!(largest_difference(before.data(), after.data(), n) <= kSamePath * extent)) return;
  x = trial;
  tangent = there;
}

}  // namespace carnot::internal
