#include "carnot/shooting/search/drift_starts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "carnot/shooting/path/action_descent.h"
#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/drift.h"
#include "carnot/shooting/path/homotopy.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"
#include "carnot/shooting/problem/manifold.h"

namespace carnot::internal {
namespace {

constexpr double kSlowest = 0.2;  // scales of the drift
constexpr double kFastest = 1.8;
constexpr int kWiggles = 3;

// How a start of the second family is made.
struct Recipe {
  double least_relaxed;
  double most_relaxed;
  double most_wiggle;  // of the way that the action of the straight line would go
  int rounds;          // of the method of multipliers
  int iterations;      // of each round
};

// Measured on van der Pol's oscillator, swing-ups of a pendulum and of a cart-pole and the flip of
// a quadrotor: over five decades of mu each of them has a range in which nearly all starts
// converge.
constexpr Recipe kQuick{1e-3, 1e2, 1, 3, 15};
// On manifolds (skate-on-sphere, rod-skate) nearly all starts converge from a relaxation of 0.3 on,
// and few below.
constexpr Recipe kQuickOnManifold{0.3, 1e2, 1, 3, 15};
// Where quick starts find too little, paths have to go far from the straight line, and much work
// pays for each. Measured on 48 problems between random states of a cart-pole with two seeds each:
// 96 quick starts find nothing in 40 of the 96 searches; with 80 thorough ones after 16 quick ones
// it is 10 if these have 8 rounds, and with 128 of 12 rounds it is 3, in 1.1 and 1.7 of the time.
// Five times as wide finds more that is not the least.
constexpr Recipe kThorough{1e-3, 0.1, 3, 12, 60};
constexpr int kQuickStarts = 16;  // easy problems have enough of them

Recipe recipe_of(const Dynamics& dynamics, int i) {
  if (dynamics.forced > 0) return kQuickOnManifold;
  return i < kQuickStarts ? kQuick : kThorough;
}

Path path_of(int dof, int intervals) {
  Path path;
  path.intervals = intervals;
  path.dof = dof;
  path.q.assign(static_cast<std::size_t>(intervals + 1) * dof, 0.0);
  return path;
}

// Inner nodes that have no nearest point there stay where they are.
void bring_nodes_to_manifold(const Dynamics& dynamics, Path& path) {
  for (int i = 1; i < path.intervals && dynamics.forced > 0; ++i) {
    std::vector<double> q(path.configuration(i), path.configuration(i) + path.dof);
    if (bring_to_manifold(dynamics, q.data())) {
      std::copy(q.begin(), q.end(), path.configuration(i));
    }
  }
}

// Random numbers of one start.
class Draws {
 public:
  Draws(std::uint64_t seed, int i) {
    std::seed_seq sequence{seed, seed >> 32U, static_cast<std::uint64_t>(i)};
    random_.seed(sequence);
  }
  double normal() { return normal_(random_); }
  double uniform(double a, double b) { return a + (b - a) * uniform_(random_); }
  std::mt19937_64& generator() { return random_; }
  double log_uniform(double a, double b) { return std::exp(uniform(std::log(a), std::log(b))); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
};

Path straight(const BoundaryValueProblem& problem, int intervals) {
  Path path = path_of(problem.dynamics.dof, intervals);
  for (int node = 0; node <= intervals; ++node) {
    const double s = static_cast<double>(node) / intervals;
    for (int j = 0; j < path.dof; ++j) {
      path.configuration(node)[j] = (1 - s) * problem.from[j] + s * problem.to[j];
    }
  }
  return path;
}

// From drift that leaves the start to drift that arrives at the target, each at a speed of its own,
// sooner or later and more or less suddenly.
Path blended_drift(const BoundaryValueProblem& problem, int intervals, Draws& draws) {
  constexpr double kSudden = 0.05;  // width of the change, of the time
  constexpr double kGradual = 0.5;
  const double h = problem.time / intervals;
  const Dynamics& dynamics = problem.dynamics;
  const auto ahead =
      drift_nodes(dynamics, draws.uniform(kSlowest, kFastest), problem.from, 0, h, intervals);
  const auto back = drift_nodes(
      dynamics, draws.uniform(kSlowest, kFastest), problem.to, problem.time, -h, intervals);
  const double centre = draws.uniform(0, 1);
  const double width = draws.log_uniform(kSudden, kGradual);
  const auto step = [&](double s) { return 1 / (1 + std::exp(-(s - centre) / width)); };
  Path path = path_of(dynamics.dof, intervals);
  for (int node = 0; node <= intervals; ++node) {
    const double s = static_cast<double>(node) / intervals;
    const double weight = (step(s) - step(0)) / (step(1) - step(0));
    // Drift that cannot be followed stays where it ended.
    const auto& left = ahead[std::min<std::size_t>(node, ahead.size() - 1)];
    const auto& right = back[std::min<std::size_t>(intervals - node, back.size() - 1)];
    for (int j = 0; j < path.dof; ++j) {
      path.configuration(node)[j] = (1 - weight) * left[j] + weight * right[j];
    }
  }
  return path;
}

double relative_residual(const DiscreteNewton& newton, const Path& path) {
  double largest = 0;
  for (const double p : path.p) largest = std::max(largest, std::abs(p));
  return largest > 0 ? newton.residual / largest : std::numeric_limits<double>::infinity();
}

}  // namespace

DriftStarts::DriftStarts(const BoundaryValueProblem& problem, std::uint64_t seed)
    : problem_(problem), seed_(seed), reach_(reach_of(problem)) {
  // Intervals for each time scale of the drift. Measured on a Kepler transfer of 16 revolutions:
  // with 4 the least was lost, and with 10 it took twice as long as with 6.
  constexpr double kPerTurn = 6;
  constexpr int kFewest = 32;
  constexpr int kMost = 4096;
  const double wanted = std::clamp<double>(kPerTurn * reach_.turns, kFewest, kMost);
  intervals_ = 8 * static_cast<int>(std::ceil(wanted / 8));
  set_action();
  scan_scales();
}

void DriftStarts::set_action() {
  constexpr int kSamples = 16;
  const BoundaryValueProblem& problem = problem_;
  const int n = problem.dynamics.dof;
  HamiltonianTerms terms(problem.dynamics);
  const std::vector<double>& rest = reach_.rest;
  std::vector<double> q(n);
  for (int i = 0; i < kSamples; ++i) {
    const double s = (i + 0.5) / kSamples;
    for (int j = 0; j < n; ++j) q[j] = (1 - s) * problem.from[j] + s * problem.to[j];
    terms.set(0, s * problem.time, q.data(), rest.data());
    if (!terms.evaluate(1, HamiltonianTerms::Order::kFirst)) continue;
    for (int j = 0; j < n; ++j) {
      const double w = (problem.to[j] - problem.from[j]) / problem.time - terms.by_p(0, j);
      action_ += 0.5 * problem.time / kSamples * w * w / reach_.sizes[j];
    }
  }
}

void DriftStarts::scan_scales() {
  // The drift of an autonomous scene at d times its speed ends where the drift itself is at d T.
  if (!problem_.dynamics.autonomous) return;
  const int n = problem_.dynamics.dof;
  const int steps = static_cast<int>(std::ceil(kFastest * intervals_));
  const double h = problem_.time / intervals_;
  const auto nodes = drift_nodes(problem_.dynamics, 1, problem_.from, 0, h, steps);
  if (nodes.size() < 2 || nodes[1] == nodes[0]) return;  // an equilibrium
  std::vector<double> miss;
  for (const auto& q : nodes) {
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      const double apart = problem_.is_free_to(j) ? 0 : q[j] - problem_.to[j];
      sum += apart * apart / reach_.sizes[j];
    }
    miss.push_back(sum);
  }
  std::vector<std::pair<double, double>> found;
  const int first = static_cast<int>(kSlowest * intervals_);
  for (int i = first; i < static_cast<int>(miss.size()); ++i) {
    const bool below_left = i == first || miss[i] < miss[i - 1];
    const bool below_right = i + 1 == static_cast<int>(miss.size()) || miss[i] <= miss[i + 1];
    if (below_left && below_right) found.emplace_back(miss[i], static_cast<double>(i) / intervals_);
  }
  std::sort(found.begin(), found.end());
  for (const auto& [distance, d] : found) scales_.push_back(d);
}

int DriftStarts::actuated() const {
  constexpr int kIntervals = 8192;  // of all of them together
  constexpr int kFewest = 12;
  constexpr int kMost = 144;
  constexpr int kMostOnManifold = 96;  // which are all quick
  const int most = problem_.dynamics.forced > 0 ? kMostOnManifold : kMost;
  return std::clamp(kIntervals / intervals_, kFewest, most);
}

RelaxedStart DriftStarts::start(int i, int intervals, const Stop& stop) const {
  if (i < scaled()) return scaled_start(scales_[i], intervals, stop);
  return actuated_start(i - scaled(), intervals, stop);
}

RelaxedStart DriftStarts::scaled_start(double d, int intervals, const Stop& stop) const {
  constexpr double kOnTheWay = 1e-5;  // tolerance of the solutions on the way
  const int n = problem_.dynamics.dof;
  const double h = problem_.time / intervals;
  RelaxedStart result;
  const auto nodes = drift_nodes(problem_.dynamics, d, problem_.from, 0, h, intervals);
  if (static_cast<int>(nodes.size()) <= intervals) return result;
  result.path = path_of(n, intervals);
  result.path.lambda.assign(static_cast<std::size_t>(intervals) * n, 0.0);
  for (int i = 0; i <= intervals; ++i) {
    std::copy(nodes[i].begin(), nodes[i].end(), result.path.configuration(i));
  }
  const std::vector<double>& end = nodes.back();
  const auto correct = [&](double s, Path& trial) {
    for (int j = 0; j < n; ++j) {
      if (problem_.is_free_to(j)) continue;
      trial.configuration(intervals)[j] = (1 - s) * end[j] + s * problem_.to[j];
    }
    DiscreteNewtonOptions newton;
    newton.max_iterations = 8;
    newton.most_damped = 2;
    newton.drift = (1 - s) * d + s;
    if (s < 1) newton.tolerance = kOnTheWay;
    const DiscreteNewton tightened = tighten(problem_, newton, trial);
    result.residual = relative_residual(tightened, trial);
    return tightened.converged;
  };
  HomotopyOptions homotopy;
  homotopy.stop = stop;
  result.found = follow(homotopy, correct, result.path);
  return result;
}

Path DriftStarts::random_path(int i, int intervals, double& relaxation) const {
  const Recipe recipe = recipe_of(problem_.dynamics, i);
  constexpr double kLeastWiggle = 0.02;
  const int n = problem_.dynamics.dof;
  Draws draws(seed_, i);
  relaxation = draws.log_uniform(recipe.least_relaxed, recipe.most_relaxed);
  const double way = std::sqrt(2 * action_ * problem_.time);
  std::vector<double> ways;  // by coordinate
  for (const double s : reach_.sizes) ways.push_back(way * std::sqrt(s));
  const bool moves = i > 0 && problem_.has_free_ends();
  const BoundaryValueProblem problem =
      moves ? with_ends_moved(problem_, ways, draws.generator()) : problem_;
  Path path = i % 4 >= 2 ? blended_drift(problem, intervals, draws) : straight(problem, intervals);
  const double size = draws.log_uniform(kLeastWiggle, recipe.most_wiggle) * way;
  for (int m = 1; m <= kWiggles && i > 0; ++m) {  // the first is the straight line itself
    for (int j = 0; j < n; ++j) {
      const double amplitude = size * std::sqrt(reach_.sizes[j]) * draws.normal() / m;
      for (int node = 1; node < intervals; ++node) {
        path.configuration(node)[j] +=
            amplitude * std::sin(m * std::numbers::pi * node / intervals);
      }
    }
  }
  bring_nodes_to_manifold(problem_.dynamics, path);
  return path;
}

RelaxedStart DriftStarts::actuated_start(int i, int intervals, const Stop& stop) const {
  const Recipe recipe = recipe_of(problem_.dynamics, i);
  ActionDescentOptions options;
  options.sizes = reach_.sizes;
  options.rest = reach_.rest;
  RelaxedStart result;
  result.path = random_path(i, intervals, options.relaxation);
  options.stop = stop;
  options.max_iterations = recipe.iterations;
  options.tolerance = 1e-3;
  for (int round = 0; round < recipe.rounds; ++round) {
    (void)reduce_action(problem_, options, result.path);
    options.centre = result.path.lambda;
  }
  Path relaxed = result.path;
  options.relaxation = 0;
  options.centre.clear();
  options.max_iterations = 60;
  options.tolerance = 1e-6;
  const ActionDescent reduced = reduce_action(problem_, options, result.path);
  // Where no shift makes a minimum, Newton's method may find what is stationary.
  if (!reduced.converged) result.path = std::move(relaxed);
  const DiscreteNewton tightened = tighten(problem_, {}, result.path);
  result.blocked = tightened.left_chart || skims_chart_end(problem_.dynamics, result.path) ||
                   (!tightened.converged && reduced.left_chart);
  result.found = tightened.converged && !result.blocked;
  result.residual = relative_residual(tightened, result.path);
  return result;
}

}  // namespace carnot::internal
