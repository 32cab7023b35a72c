#include "carnot/shooting/end_point.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace carnot {

double largest_difference(const double* a, const double* b, int count) {
  double largest = 0;
  for (int j = 0; j < count; ++j) {
    const double difference = std::abs(a[j] - b[j]);
    largest = difference <= largest ? largest : difference;  // keeps a NaN
  }
  return largest;
}

int nullity(const Eigen::MatrixXd& x) {
  constexpr double kSingular = 1e-10;
  const Eigen::VectorXd values = Eigen::JacobiSVD<Eigen::MatrixXd>(x).singularValues();
  return static_cast<int>((values.array() <= kSingular * values[0]).count());
}

std::optional<Eigen::MatrixXd> end_point_jacobian(const BoundaryValueProblem& problem,
                                                  const std::vector<double>& p0,
                                                  double t,
                                                  long steps,
                                                  std::vector<double>& z) {
  const int n = problem.segment.dof;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> m(2 * n, 2 * n);
  z = problem.from;
  z.insert(z.end(), p0.begin(), p0.end());
  const StepPlan plan = StepPlan::equal(0, t, steps);
  if (!problem.segment.tangent_flow(plan, z.data(), m.data()).completed()) return std::nullopt;
  if (!m.allFinite()) return std::nullopt;
  return Eigen::MatrixXd(m.topRightCorner(n, n));
}

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

}  // namespace carnot
