#include "carnot/shooting/path/action_descent.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "carnot/shooting/linear/banded_ldlt.h"
#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/path/path_lagrangian.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"

namespace carnot::internal {
namespace {

class Reduction {
 public:
  Reduction(const BoundaryValueProblem& problem, const ActionDescentOptions& options, Path& path)
      : problem_(problem),
        options_(options),
        path_(path),
        n_(path.dof),
        intervals_(path.intervals),
        h_(problem.time / path.intervals),
        terms_(problem.dynamics),
        hessian_(static_cast<std::size_t>(intervals_) * 3 * n_ * n_),
        unknown_(static_cast<std::size_t>(intervals_ + 1) * n_, -1),
        size_(number_unknowns()),
        matrix_(size_, 3 * n_ - 1),
        weights_(n_, 0.0) {}

  ActionDescent run();

 private:
  // What is known of the intervals of a path, to first order.
  struct State {
    Path path;
    bool exists = false;
    double action = 0;
    std::vector<double> defect;  // v - H_p, intervals x n
    std::vector<double> by_q;    // H_q
  };

  // Unknowns are ordered q_0, s_0, q_1, s_1, q_2, ..., s_{N-1}, q_N; of the ends what is free.
  int number_unknowns();
  [[nodiscard]] int momentum_at(int i) const { return first_ + 2 * i * n_; }
  // Coordinate j of node i; -1 where it is fixed.
  [[nodiscard]] int node_at(int i, int j) const { return unknown_[i * n_ + j]; }
  [[nodiscard]] double centre(int i, int j) const {
    return options_.centre.empty() ? 0.0 : options_.centre[i * n_ + j];
  }
  [[nodiscard]] double relaxed(int j) const { return options_.relaxation * options_.sizes[j]; }
  // The unit of H_qq: what moves S in the time T costs.
  [[nodiscard]] double stiffness(int j) const {
    return 1 / (problem_.time * problem_.time * options_.sizes[j]);
  }

  bool evaluate(State& state, bool second);
  // The momenta that make the relaxed defects vanish, to first order in those at hand.
  void set_momenta();
  [[nodiscard]] double merit(const State& state) const;
  [[nodiscard]] std::vector<double> gradient(const State& state) const;
  [[nodiscard]] double residual(const State& state) const;
  // Factors the Hessian, shifted until its inertia is right. False where it never is.
  bool factor();
  void assemble(double shift);
  // Overwrites b by the solution of the Hessian without its regularisation.
  void solve(std::vector<double>& b);
  [[nodiscard]] double slope(const std::vector<double>& step) const;
  void raise_weights(const std::vector<double>& step);
  void move(const State& from, const std::vector<double>& step, double by, State& to) const;
  bool advance(const std::vector<double>& step, ActionDescent& result);

  const BoundaryValueProblem& problem_;
  const ActionDescentOptions& options_;
  Path& path_;
  int n_;
  int intervals_;
  double h_;
  HamiltonianTerms terms_;
  State state_;
  State trial_;
  std::vector<double> hessian_;  // qq, qp, pp of each interval
  int first_ = 0;                // how many coordinates of q_0 are free
  std::vector<int> unknown_;     // of the nodes
  int size_;
  BandedLdlt matrix_;
  std::vector<double> weights_;  // nu
  double shift_ = 0;
  double last_shift_ = 0;
};

// So much of the sizes is taken off -H_pp, which is singular where not all coordinates are
// actuated: the factors need no pivots then. solve() puts it back by refinement, which gains eight
// digits a round.
constexpr double kRegularised = 1e-8;
// The shift of the block of the nodes, in units of 1 / (T^2 S): the first one that is tried.
constexpr double kFirstShift = 1e-2;
constexpr double kLeastShift = 1e-6;
constexpr double kDown = 1.0 / 4;
constexpr double kUp = 8;

// In natural scales, where those of an extremal are of size one. What is beyond is no use, and
// Newton's method for the algebraic variables takes longest where it fails.
constexpr double kLargestMomentum = 1e10;

int Reduction::number_unknowns() {
  int next = 0;
  for (int i = 0; i <= intervals_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const bool fixed =
          (i == 0 && !problem_.is_free_from(j)) || (i == intervals_ && !problem_.is_free_to(j));
      if (!fixed) unknown_[i * n_ + j] = next++;
    }
    if (i == 0) first_ = next;
    if (i < intervals_) next += n_;
  }
  return next;
}

bool Reduction::evaluate(State& state, bool second) {
  state.exists = false;
  for (const double s : state.path.lambda) {
    if (!(std::abs(s) < kLargestMomentum)) return false;
  }
  state.defect.resize(intervals_ * n_);
  state.by_q.resize(intervals_ * n_);
  state.action = 0;
  state.exists = true;
  const auto order = second ? HamiltonianTerms::Order::kSecond : HamiltonianTerms::Order::kFirst;
  for (int i = 0; i < intervals_ && state.exists; ++i) {
    const int point = i % HamiltonianTerms::kPoints;
    if (point == 0) state.exists = evaluate_middles(state.path, h_, i, order, terms_);
    const double* left = state.path.configuration(i);
    const double* right = state.path.configuration(i + 1);
    const double* s = &state.path.lambda[i * n_];
    state.action -= h_ * terms_.value(point);
    for (int j = 0; j < n_; ++j) {
      const double aside = s[j] - centre(i, j);
      const double by_p = terms_.by_p(point, j) + relaxed(j) * aside;
      state.action += h_ * (s[j] * by_p - 0.5 * relaxed(j) * aside * aside);
      state.defect[i * n_ + j] = (right[j] - left[j]) / h_ - by_p;
      state.by_q[i * n_ + j] = terms_.by_q(point, j);
    }
    if (!second) continue;
    double* block = &hessian_[static_cast<std::size_t>(i) * 3 * n_ * n_];
    for (int a = 0; a < n_; ++a) {
      for (int b = 0; b < n_; ++b) {
        const int at = a * n_ + b;
        block[at] = terms_.qq(point, a, b);
        block[n_ * n_ + at] = terms_.qp(point, a, b);
        block[2 * n_ * n_ + at] = terms_.pp(point, a, b) + (a == b ? relaxed(a) : 0);
      }
    }
  }
  state.exists = state.exists && std::isfinite(state.action);
  return state.exists;
}

void Reduction::set_momenta() {
  Eigen::MatrixXd pp(n_, n_);
  Eigen::VectorXd defect(n_);
  for (int i = 0; i < intervals_; ++i) {
    const double* block = &hessian_[(static_cast<std::size_t>(i) * 3 + 2) * n_ * n_];
    for (int a = 0; a < n_; ++a) {
      defect[a] = state_.defect[i * n_ + a];
      for (int b = 0; b < n_; ++b) pp(a, b) = block[a * n_ + b];
    }
    const Eigen::VectorXd change = product(lu_inverse(pp), defect);
    for (int a = 0; a < n_; ++a) state_.path.lambda[i * n_ + a] += change[a];
  }
}

double Reduction::merit(const State& state) const {
  if (!state.exists) return std::numeric_limits<double>::infinity();
  double penalty = 0;
  for (int i = 0; i < intervals_; ++i) {
    for (int j = 0; j < n_; ++j) penalty += weights_[j] * std::abs(state.defect[i * n_ + j]);
  }
  return state.action + h_ * penalty;
}

std::vector<double> Reduction::gradient(const State& state) const {
  std::vector<double> g(size_, 0.0);
  for (int i = 0; i < intervals_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const int left = node_at(i, j);
      const int right = node_at(i + 1, j);
      const double s = state.path.lambda[i * n_ + j];
      const double force = 0.5 * h_ * state.by_q[i * n_ + j];
      g[momentum_at(i) + j] = h_ * state.defect[i * n_ + j];
      if (left >= 0) g[left] += -s - force;
      if (right >= 0) g[right] += s - force;
    }
  }
  return g;
}

double Reduction::residual(const State& state) const {
  // A coordinate that is free at both ends may keep still and have no momentum at all. It is
  // measured by the others.
  constexpr double kLeast = 1e-3;
  const std::vector<double> g = gradient(state);
  double common_way = 0;
  double common_momentum = 0;
  for (int i = 0; i < intervals_ && problem_.has_free_ends(); ++i) {
    for (int j = 0; j < n_; ++j) {
      const double root = std::sqrt(options_.sizes[j]);
      const double step = state.path.configuration(i + 1)[j] - state.path.configuration(i)[j];
      common_way = std::max(common_way, kLeast * std::abs(step) / root);
      common_momentum =
          std::max(common_momentum, kLeast * std::abs(state.path.lambda[i * n_ + j]) * root);
    }
  }
  double worst = 0;
  for (int j = 0; j < n_; ++j) {
    double way = common_way * std::sqrt(options_.sizes[j]);
    double momentum = common_momentum / std::sqrt(options_.sizes[j]);
    double defect = 0;
    double force = 0;
    for (int i = 0; i < intervals_; ++i) {
      const double step = state.path.configuration(i + 1)[j] - state.path.configuration(i)[j];
      way = std::max(way, std::abs(step));
      momentum = std::max(momentum, std::abs(state.path.lambda[i * n_ + j]));
      defect = std::max(defect, std::abs(g[momentum_at(i) + j]));
    }
    for (int i = 0; i <= intervals_; ++i) {
      if (node_at(i, j) >= 0) force = std::max(force, std::abs(g[node_at(i, j)]));
    }
    if (defect > 0) worst = std::max(worst, defect / std::max(way, 1e-300));
    if (force > 0) worst = std::max(worst, force / std::max(momentum, 1e-300));
  }
  return worst;
}

void Reduction::assemble(double shift) {
  matrix_.clear();
  const auto add = [&](int row, int column, double entry) {
    if (row >= 0 && column >= row) matrix_(row, column) += entry;
  };
  for (int i = 0; i < intervals_; ++i) {
    const double* qq = &hessian_[static_cast<std::size_t>(i) * 3 * n_ * n_];
    const double* qp = qq + n_ * n_;
    const double* pp = qp + n_ * n_;
    const int s = momentum_at(i);
    for (int a = 0; a < n_; ++a) {
      const int left = node_at(i, a);
      const int right = node_at(i + 1, a);
      for (int b = 0; b < n_; ++b) {
        const double by_nodes = -0.25 * h_ * qq[a * n_ + b];
        const double mixed = -0.5 * h_ * qp[a * n_ + b];
        const double same = a == b ? 1 : 0;
        add(left, node_at(i, b), by_nodes);
        add(left, s + b, mixed - same);
        add(left, node_at(i + 1, b), by_nodes);
        add(right, node_at(i + 1, b), by_nodes);
        add(s + b, right, mixed + same);
        add(s + a, s + b, -h_ * (pp[a * n_ + b] + same * kRegularised * options_.sizes[a]));
      }
      if (i == 0) add(left, left, shift * h_ * stiffness(a));
      add(right, right, shift * h_ * stiffness(a));
    }
  }
}

bool Reduction::factor() {
  constexpr double kLargest = 1e12;
  double shift = shift_;
  for (;;) {
    assemble(shift);
    const auto negative = matrix_.factor();
    if (negative && *negative == intervals_ * n_) break;
    shift = shift > 0 ? kUp * shift : std::max(kFirstShift, kDown * last_shift_);
    if (shift > kLargest) return false;
  }
  if (shift > 0) last_shift_ = shift;
  shift_ = shift;
  return true;
}

void Reduction::solve(std::vector<double>& b) {
  // Three rounds took a quarter of the search of a skate on its sphere. With one the drift problems
  // of docs/verification.md are found as before.
  constexpr int kRefinements = 1;
  const std::vector<double> right = b;
  matrix_.substitute(b);
  for (int round = 0; round < kRefinements; ++round) {
    std::vector<double> next = right;
    for (int i = 0; i < intervals_; ++i) {
      for (int j = 0; j < n_; ++j) {
        const int at = momentum_at(i) + j;
        next[at] -= h_ * kRegularised * options_.sizes[j] * b[at];
      }
    }
    matrix_.substitute(next);
    b = std::move(next);
  }
}

double Reduction::slope(const std::vector<double>& step) const {
  double slope = 0;
  std::vector<double> dq(n_);
  for (int i = 0; i < intervals_; ++i) {
    const double* block = &hessian_[static_cast<std::size_t>(i) * 3 * n_ * n_];
    const double* qp = block + n_ * n_;
    const double* pp = qp + n_ * n_;
    for (int j = 0; j < n_; ++j) {
      const int left = node_at(i, j);
      const int right = node_at(i + 1, j);
      dq[j] = 0.5 * ((left >= 0 ? step[left] : 0) + (right >= 0 ? step[right] : 0));
    }
    for (int a = 0; a < n_; ++a) {
      double rate = 0;  // of the change of H_p
      for (int b = 0; b < n_; ++b) {
        rate += qp[b * n_ + a] * dq[b] + pp[a * n_ + b] * step[momentum_at(i) + b];
      }
      const double s = state_.path.lambda[i * n_ + a];
      slope += h_ * (s * rate - state_.by_q[i * n_ + a] * dq[a]);
      slope -= h_ * weights_[a] * std::abs(state_.defect[i * n_ + a]);
    }
  }
  return slope;
}

void Reduction::raise_weights(const std::vector<double>& step) {
  constexpr double kAbove = 1.2;
  constexpr double kForget = 0.7;
  for (int j = 0; j < n_; ++j) {
    double largest = 0;
    for (int i = 0; i < intervals_; ++i) {
      const double s = state_.path.lambda[i * n_ + j] + step[momentum_at(i) + j];
      largest = std::max(largest, std::abs(s));
    }
    weights_[j] = std::max(kForget * weights_[j], kAbove * largest);
  }
}

void Reduction::move(const State& from,
                     const std::vector<double>& step,
                     double by,
                     State& to) const {
  to.path = from.path;
  for (int i = 0; i <= intervals_; ++i) {
    for (int j = 0; j < n_; ++j) {
      if (i < intervals_) to.path.lambda[i * n_ + j] += by * step[momentum_at(i) + j];
      if (node_at(i, j) >= 0) to.path.configuration(i)[j] += by * step[node_at(i, j)];
    }
  }
}

// A step along the direction, as long as it pays. False where none does.
bool Reduction::advance(const std::vector<double>& step, ActionDescent& result) {
  constexpr double kShortest = 1.0 / 512;
  constexpr double kEnough = 1e-4;  // of the decrease that the slope promises
  constexpr double kRoundOff = 1e-13;
  const double before = merit(state_);
  const double promised = slope(step);
  const double noise = kRoundOff * (std::abs(before) + std::abs(state_.action));
  const bool walled = in_one_chart(problem_.dynamics, state_.path);
  const auto pays = [&](double by) {
    result.left_chart = walled && !in_one_chart(problem_.dynamics, trial_.path);
    return !result.left_chart && evaluate(trial_, false) &&
           merit(trial_) <= before + kEnough * by * std::min(promised, 0.0) + noise;
  };
  for (double by = 1; by >= kShortest; by *= 0.5) {
    move(state_, step, by, trial_);
    if (pays(by)) return true;
    if (by < 1 || !trial_.exists || result.left_chart) continue;
    std::vector<double> correction(size_, 0.0);
    for (int i = 0; i < intervals_; ++i) {
      for (int j = 0; j < n_; ++j) {
        correction[momentum_at(i) + j] = -h_ * trial_.defect[i * n_ + j];
      }
    }
    solve(correction);
    State corrected = trial_;
    move(trial_, correction, 1, corrected);
    std::swap(trial_, corrected);
    if (pays(1)) return true;
  }
  return false;
}

ActionDescent Reduction::run() {
  ActionDescent result;
  const bool momenta = !path_.lambda.empty();
  for (int i = 0; i < intervals_ && !momenta; ++i) {
    path_.lambda.insert(path_.lambda.end(), options_.rest.begin(), options_.rest.end());
  }
  state_.path = path_;
  if (!evaluate(state_, true)) return result;
  if (!momenta) {
    set_momenta();
    if (!evaluate(state_, true)) return result;
  }
  result.residual = residual(state_);
  constexpr int kMostRefused = 6;
  int refused = 0;
  while (result.iterations < options_.max_iterations && !options_.stop.reached()) {
    result.converged = result.residual <= options_.tolerance;
    if (result.converged) break;
    ++result.iterations;
    if (!factor()) break;
    std::vector<double> step = gradient(state_);
    for (double& x : step) x = -x;
    solve(step);
    raise_weights(step);
    if (!advance(step, result)) {
      if (++refused > kMostRefused) break;
      shift_ = std::max(kFirstShift, kUp * std::max(shift_, last_shift_));
      continue;
    }
    refused = 0;
    shift_ = shift_ > kLeastShift ? kDown * shift_ : 0;
    std::swap(state_, trial_);
    if (!evaluate(state_, true)) break;
    result.residual = residual(state_);
  }
  path_ = state_.path;
  return result;
}

}  // namespace

ActionDescent reduce_action(const BoundaryValueProblem& problem,
                            const ActionDescentOptions& options,
                            Path& path) {
  return Reduction(problem, options, path).run();
}

}  // namespace carnot::internal
