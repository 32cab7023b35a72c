#include "carnot/shooting/path/drift.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"

namespace carnot::internal {
namespace {

// Solves next = q + h f((q + next) / 2) by Newton's method from next = q + h f(q).
bool midpoint_step(HamiltonianTerms& terms,
                   double t,
                   double h,
                   const std::vector<double>& q,
                   std::vector<double>& next) {
  constexpr int kMostIterations = 12;
  constexpr double kTolerance = 1e-12;
  const auto n = static_cast<int>(q.size());
  const std::vector<double> rest(n, 0.0);
  terms.set(0, t, q.data(), rest.data());
  if (!terms.evaluate(1, HamiltonianTerms::Order::kFirst)) return false;
  for (int j = 0; j < n; ++j) next[j] = q[j] + h * terms.by_p(0, j);
  std::vector<double> middle(n);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    for (int j = 0; j < n; ++j) middle[j] = 0.5 * (q[j] + next[j]);
    terms.set(0, t + 0.5 * h, middle.data(), rest.data());
    if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) return false;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd residual(n);
    double size = 0;
    for (int a = 0; a < n; ++a) {
      residual[a] = next[a] - q[a] - h * terms.by_p(0, a);
      size = std::max({size, std::abs(q[a]), std::abs(next[a])});
      for (int b = 0; b < n; ++b) matrix(a, b) -= 0.5 * h * terms.qp(0, b, a);
    }
    const Eigen::VectorXd change = product(lu_inverse(matrix), residual);
    if (!change.allFinite()) return false;
    for (int j = 0; j < n; ++j) next[j] -= change[j];
    if (change.cwiseAbs().maxCoeff() <= kTolerance * std::max(size, 1e-300)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::vector<double>> drift_nodes(const Dynamics& dynamics,
                                             double d,
                                             const std::vector<double>& q,
                                             double t,
                                             double h,
                                             int steps) {
  HamiltonianTerms terms(dynamics, d);
  std::vector<std::vector<double>> nodes{q};
  std::vector<double> next(q.size());
  for (int i = 0; i < steps; ++i) {
    if (!midpoint_step(terms, t + i * h, h, nodes.back(), next)) break;
    nodes.push_back(next);
  }
  return nodes;
}

}  // namespace carnot::internal
