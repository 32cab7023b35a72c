#include "carnot/shooting/problem/reach.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"
#include "carnot/shooting/problem/manifold.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;

// The mean of diag(H_pp) at points q beside the straight line. choose(q) moves one from the line to
// where it is wanted, and returns false where there is no such point.
template <class Choose>
std::vector<double> mean_sizes(const BoundaryValueProblem& problem,
                               const std::vector<double>& rest,
                               int samples,
                               const Choose& choose) {
  const int n = problem.dynamics.dof;
  HamiltonianTerms terms(problem.dynamics);
  std::vector<double> sizes(n, 0.0);
  std::vector<double> q(n);
  for (int i = 0; i < samples; ++i) {
    const double s = (i + 0.5) / samples;
    for (int j = 0; j < n; ++j) q[j] = (1 - s) * problem.from[j] + s * problem.to[j];
    if (!choose(q)) continue;
    terms.set(0, s * problem.time, q.data(), rest.data());
    if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) continue;
    for (int j = 0; j < n; ++j) sizes[j] += terms.pp(0, j, j) / samples;
  }
  return sizes;
}

// On the manifold: what the start cannot move for the constraints, other points can.
std::vector<double> sizes_on_manifold(const BoundaryValueProblem& problem,
                                      const std::vector<double>& rest) {
  return mean_sizes(problem, rest, 16, [&](std::vector<double>& q) {
    return bring_to_manifold(problem.dynamics, q.data());
  });
}

// Around the line: angles as far as a quarter turn away, other coordinates as far as they go
// themselves. What the start cannot move, as a car cannot move sideways, other points can.
std::vector<double> sizes_around(const BoundaryValueProblem& problem,
                                 const std::vector<double>& rest) {
  std::mt19937_64 random;
  std::uniform_real_distribution<double> uniform(-1, 1);
  return mean_sizes(problem, rest, 64, [&](std::vector<double>& q) {
    for (int j = 0; j < problem.dynamics.dof; ++j) {
      const double period = problem.dynamics.info.configuration[j].period;
      const double away = period > 0 ? period / 4 : problem.to[j] - problem.from[j];
      q[j] += away * uniform(random);
    }
    return true;
  });
}

}  // namespace

std::vector<double> straight_momentum(const BoundaryValueProblem& problem) {
  const Dynamics& dynamics = problem.dynamics;
  std::vector<double> velocity(dynamics.dof);
  for (int j = 0; j < dynamics.dof; ++j) {
    velocity[j] = (problem.to[j] - problem.from[j]) / problem.time;
  }
  std::vector<double> admissible = velocity;
  std::vector<double> p(dynamics.dof);
  const std::vector<double> lambda(dynamics.multipliers, 0.0);
  dynamics.momentum(0, problem.from, admissible, lambda, p);
  const bool finite = std::all_of(p.begin(), p.end(), [](double x) { return std::isfinite(x); });
  return finite ? p : velocity;
}

Reach reach_of(const BoundaryValueProblem& problem) {
  constexpr int kSteps = 512;
  constexpr double kTurn = 2;  // a time scale: so much for the integral of the fastest rate
  const int n = problem.dynamics.dof;
  const double h = problem.time / kSteps;
  HamiltonianTerms terms(problem.dynamics);
  Reach reach;
  reach.rest.assign(n, 0.0);
  terms.set(0, 0, problem.from.data(), reach.rest.data());
  if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) reach.rest = straight_momentum(problem);
  const std::vector<double>& rest = reach.rest;
  std::vector<double> q = problem.from;
  MatrixXd gramian = MatrixXd::Zero(n, n);
  reach.sizes.assign(n, 0.0);
  double followed = 0;
  for (int i = 0; i < kSteps; ++i) {
    terms.set(0, i * h, q.data(), rest.data());
    if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) break;
    MatrixXd a(n, n);
    MatrixXd d(n, n);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c < n; ++c) {
        a(r, c) = terms.qp(0, c, r);
        d(r, c) = terms.pp(0, r, c);
      }
    }
    const double radius = spectral_radius(a);
    if (!std::isfinite(radius)) break;
    // The Gramian over the first time scale, or over all of [0, T] where the drift is slower.
    if (i == 0 || reach.turns < kTurn) {
      const MatrixXd ha = h * a;
      const MatrixXd f = MatrixXd::Identity(n, n) + ha + 0.5 * product(ha, ha);
      gramian = product(product(f, gramian), f.transpose()) + h * d;
      for (int j = 0; j < n; ++j) reach.sizes[j] = gramian(j, j) / ((i + 1) * h);
    }
    reach.turns += h * radius;
    followed = (i + 1) * h;
    // Heun's rule is enough for sizes.
    std::vector<double> ahead(n);
    std::vector<double> rate(n);
    for (int j = 0; j < n; ++j) rate[j] = terms.by_p(0, j);
    for (int j = 0; j < n; ++j) ahead[j] = q[j] + h * rate[j];
    terms.set(0, (i + 1) * h, ahead.data(), rest.data());
    if (!terms.evaluate(1, HamiltonianTerms::Order::kFirst)) break;
    for (int j = 0; j < n; ++j) q[j] += 0.5 * h * (rate[j] + terms.by_p(0, j));
  }
  if (followed > 0) reach.turns *= problem.time / followed;
  if (problem.dynamics.forced > 0) {
    reach.sizes = sizes_on_manifold(problem, rest);
  } else {
    // Of 150 searches for a car that is written as a Lagrangian, depends on the time or stands on a
    // belt 61 find nothing and 23 not the least without this; with it all do, in a twentieth of the
    // time.
    constexpr double kHardly = 1e-2;
    const std::vector<double> around = sizes_around(problem, rest);
    for (int j = 0; j < n; ++j) {
      if (reach.sizes[j] < kHardly * around[j]) reach.sizes[j] = around[j];
    }
  }
  // A coordinate that controls do not reach so soon.
  const double largest = *std::max_element(reach.sizes.begin(), reach.sizes.end());
  for (double& size : reach.sizes) size = std::max(size, 1e-6 * (largest > 0 ? largest : 1));
  return reach;
}

}  // namespace carnot::internal
