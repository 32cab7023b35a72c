#include "carnot/shooting/path/relaxation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "carnot/shooting/linear/chain_least_squares.h"
#include "carnot/shooting/linear/lanes.h"
#include "carnot/shooting/path/middles.h"
#include "carnot/shooting/problem/walls.h"

namespace carnot::internal {
namespace {

static_assert(Middles::kLanes == kLanes);

// Reads the terms of all intervals of a path, up to the first that cannot be evaluated.
struct PathTerms {
  double action = 0;
  double violation = 0;
  double max_potential = 0;
  double mass = 0;  // mean |r|^2 / |v|^2
  bool potential = false;
  std::vector<double> constraint;  // intervals x k
};

PathTerms terms_of(const Dynamics& dynamics, double h, const Path& path) {
  const int n = dynamics.dof;
  const int k = dynamics.transcribed;
  PathTerms result;
  Middles middles(n);
  std::vector<double> terms((n + k + 1) * kLanes);
  double largest_speed = 0;
  double largest_constraint = 0;
  double kinetic = 0;
  double speed = 0;
  for (int i = 0; i < path.intervals; ++i) {
    const int l = i % kLanes;
    if (l == 0) {
      middles.set(path.configuration(i), std::min(kLanes, path.intervals - i), h);
      if (!dynamics.midpoints(middles.q(), middles.v(), terms)) break;
    }
    double v2 = 0;
    double r2 = 0;
    double c2 = 0;
    for (int j = 0; j < n; ++j) v2 += middles.v()[j * kLanes + l] * middles.v()[j * kLanes + l];
    for (int j = 0; j < n; ++j) r2 += terms[j * kLanes + l] * terms[j * kLanes + l];
    for (int j = n; j < n + k; ++j) {
      const double c = terms[j * kLanes + l];
      c2 += c * c;
      result.constraint.push_back(c);
    }
    const double potential = terms[(n + k) * kLanes + l];
    result.action += h * (0.5 * r2 - potential);
    kinetic += r2;
    speed += v2;
    largest_speed = std::max(largest_speed, std::sqrt(v2));
    largest_constraint = std::max(largest_constraint, std::sqrt(c2));
    result.max_potential = i == 0 ? potential : std::max(result.max_potential, potential);
    result.potential = result.potential || potential != 0;
  }
  result.violation = largest_speed > 0 ? largest_constraint / largest_speed : 0;
  result.mass = speed > 0 ? kinetic / speed : 1;
  return result;
}

// What the residuals of a path are made with.
struct Pull {
  RelaxationTask* task = nullptr;
  int outer = 0;  // how often the multipliers were updated
  double rho = 0;
  double ceiling = 0;      // c > V; used where the scene has a potential
  bool potential = false;  // V is not zero
  bool walled = false;     // the path is in one chart, and kept there
};

// Residuals sqrt(h) r, sqrt(h rho) (G v - lambda / rho) and, with a potential, sqrt(2 h (c - V)) of
// one interval of kLanes paths side by side; keeps room for what it needs on the way.
class Intervals {
 public:
  Intervals(const BoundaryValueProblem& problem, int intervals, bool potential, const Walls& walls)
      : dynamics_(problem.dynamics),
        h_(problem.time / intervals),
        potential_(potential),
        walls_(walls),
        middles_(dynamics_.dof),
        terms_((dynamics_.dof + dynamics_.transcribed + 1) * kLanes),
        derivative_(terms_.size() * 2 * dynamics_.dof),
        left_(dynamics_.dof),
        right_(dynamics_.dof),
        s_(walls.size()),
        gradients_(s_.size() * dynamics_.dof),
        shifts_(static_cast<std::size_t>(intervals) * dynamics_.transcribed) {}

  [[nodiscard]] int residuals() const { return terms() + walls_.size(); }

  // The residuals of lane l are those of this pull from now on.
  void set_lane(int l, const Pull& pull) {
    pulls_[l] = &pull;
    weight_.at[l] = std::sqrt(h_ * pull.rho);
    ceiling_.at[l] = pull.ceiling;
    counts_.at[l] = pull.potential ? 1 : 0;
    const std::vector<double>& lambda = pull.task->path->lambda;
    for (std::size_t i = 0; i < lambda.size(); ++i) shifts_[i].at[l] = lambda[i] / pull.rho;
  }

  // Of interval i; see chain_least_squares.h.
  void evaluate(int i, const double* nodes, double* residuals, double* jacobian) {
    const int n = dynamics_.dof;
    middles_.set_lanes(nodes, h_);
    // A path whose terms do not exist has no numbers there, which its cost tells.
    (void)dynamics_.midpoints(middles_.q(), middles_.v(), terms_, derivative_);
    const LanePack per_h(1 / h_);
    for (int row = 0; row < terms(); ++row) {
      const LanePack weight = scale(i, row, residuals + row * kLanes);
      const double* d = &derivative_[row * 2 * n * kLanes];
      double* to = jacobian + row * 2 * n * kLanes;
      for (int j = 0; j < n; ++j) {
        const LanePack by_q = LanePack(0.5) * weight * LanePack::load(d + j * kLanes);
        const LanePack by_v = weight * per_h * LanePack::load(d + (n + j) * kLanes);
        (by_q - by_v).store(to + j * kLanes);
        (by_q + by_v).store(to + (n + j) * kLanes);
      }
    }
    for (int l = 0; l < kLanes; ++l) {
      if (pulls_[l] == nullptr) continue;
      if (pulls_[l]->walled && leaves_chart(l, nodes)) {
        residuals[l] = std::numeric_limits<double>::quiet_NaN();
      }
      if (walls_.size() > 0) add_walls(pulls_[l]->task->options, l, residuals, jacobian);
    }
  }

 private:
  [[nodiscard]] int terms() const {
    return dynamics_.dof + dynamics_.transcribed + (potential_ ? 1 : 0);
  }

  // Sets residual `row` of all lanes from the terms, returns d residual / d term.
  LanePack scale(int i, int row, double* residuals) const {
    const int n = dynamics_.dof;
    const int k = dynamics_.transcribed;
    const LanePack terms = LanePack::load(&terms_[row * kLanes]);
    if (row < n) {
      const LanePack weight(std::sqrt(h_));
      (weight * terms).store(residuals);
      return weight;
    }
    if (row < n + k) {
      const LanePack weight = weight_.pack();
      (weight * (terms - shifts_[i * k + row - n].pack())).store(residuals);
      return weight;
    }
    const LanePack root = sqrt(LanePack(2 * h_) * (ceiling_.pack() - terms));
    const LanePack::Mask counts = counts_.pack() > LanePack(0);
    select(counts, root, LanePack(0)).store(residuals);
    return select(counts, LanePack(-h_) / root, LanePack(0));
  }

  bool leaves_chart(int l, const double* nodes) {
    const int n = dynamics_.dof;
    for (int j = 0; j < n; ++j) {
      left_[j] = nodes[j * kLanes + l];
      right_[j] = nodes[(n + j) * kLanes + l];
    }
    return !same_chart(dynamics_, left_.data(), right_.data());
  }

  // The last residuals of lane l: what is beyond each wall.
  void add_walls(const RelaxationOptions& options, int l, double* residuals, double* jacobian) {
    const int n = dynamics_.dof;
    for (int j = 0; j < n; ++j) left_[j] = middles_.q()[j * kLanes + l];
    walls_.evaluate(left_.data(), s_.data(), gradients_.data(), nullptr);
    for (int w = 0; w < walls_.size(); ++w) {
      const int row = terms() + w;
      const double weight = std::sqrt(h_ * options.wall_rate) / options.wall_sizes[w];
      const bool beyond = s_[w] < 0;
      residuals[row * kLanes + l] = beyond ? weight * s_[w] : 0;
      double* to = jacobian + row * 2 * n * kLanes + l;
      for (int j = 0; j < n; ++j) {
        to[j * kLanes] = to[(n + j) * kLanes] = beyond ? 0.5 * weight * gradients_[w * n + j] : 0;
      }
    }
  }

  const Dynamics& dynamics_;
  double h_;
  bool potential_;
  const Walls& walls_;
  Middles middles_;
  std::vector<double> terms_;
  std::vector<double> derivative_;
  std::vector<double> left_;
  std::vector<double> right_;
  std::vector<double> s_;
  std::vector<double> gradients_;
  // Of each lane: how it is pulled, sqrt(h rho), c, whether V counts, and lambda / rho.
  std::array<const Pull*, kLanes> pulls_{};
  Lanes weight_;
  Lanes ceiling_;
  Lanes counts_;
  std::vector<Lanes> shifts_;
};

// How the path of a task is pulled. Its task is null where its terms do not exist.
Pull pull_of(const BoundaryValueProblem& problem, RelaxationTask& task) {
  const Dynamics& dynamics = problem.dynamics;
  Path& path = *task.path;
  Pull pull;
  const PathTerms state = terms_of(dynamics, problem.time / path.intervals, path);
  path.lambda.resize(static_cast<std::size_t>(path.intervals) * dynamics.transcribed, 0.0);
  if (state.constraint.size() != path.lambda.size() || !std::isfinite(state.action)) return pull;
  pull.task = &task;
  pull.rho = task.options.penalty * state.mass;
  pull.ceiling = state.max_potential + 1 + std::abs(state.max_potential);
  pull.potential = state.potential;
  pull.walled = in_one_chart(dynamics, path);
  return pull;
}

// Updates the multipliers after an inner problem. False where the path is as good as it gets.
bool update(const BoundaryValueProblem& problem, int iterations, Pull& pull) {
  RelaxationTask& task = *pull.task;
  Path& path = *task.path;
  task.result.iterations += iterations;
  const PathTerms state = terms_of(problem.dynamics, problem.time / path.intervals, path);
  const bool whole = state.constraint.size() == path.lambda.size();
  for (std::size_t i = 0; whole && i < path.lambda.size(); ++i) {
    path.lambda[i] -= pull.rho * state.constraint[i];
  }
  task.result.action = state.action;
  task.result.violation = state.violation;
  task.result.feasible = state.violation < task.options.feasibility;
  ++pull.outer;
  return whole && !task.result.feasible && pull.outer < task.options.outer_iterations;
}

}  // namespace

void relax(const BoundaryValueProblem& problem, std::span<RelaxationTask> tasks) {
  if (tasks.empty()) return;
  const int intervals = tasks.front().path->intervals;
  std::vector<Pull> waiting;
  bool potential = false;
  for (RelaxationTask& task : tasks) {
    assert(task.path->intervals == intervals);
    const Pull pull = pull_of(problem, task);
    if (pull.task == nullptr) continue;
    potential = potential || pull.potential;
    waiting.push_back(pull);
  }
  const Walls walls(problem.limits, problem.dynamics.dof);
  Intervals residuals(problem, intervals, potential, walls);
  ChainOptions inner;
  inner.max_iterations = tasks.front().options.inner_iterations;
  inner.free_first = problem.free_from;
  inner.free_last = problem.free_to;
  std::array<Pull*, kLanes> pulls{};
  auto first = waiting.begin();
  const NextChain next = [&](int lane, int iterations, std::vector<double>& nodes) -> double {
    Pull*& pull = pulls[lane];
    if (pull != nullptr) {
      pull->task->path->q = nodes;
      if (!update(problem, iterations, *pull)) pull = nullptr;
    }
    if (pull == nullptr && first != waiting.end()) {
      pull = &*first++;
      nodes = pull->task->path->q;
    }
    if (pull == nullptr) return 0;
    residuals.set_lane(lane, *pull);
    return 1 / pull->task->options.caution;
  };
  minimise_chains(
      [&](int i, const double* nodes, double* values, double* jacobian) {
        residuals.evaluate(i, nodes, values, jacobian);
      },
      {intervals, problem.dynamics.dof, residuals.residuals()},
      inner,
      next);
}

Relaxation relax(const BoundaryValueProblem& problem,
                 const RelaxationOptions& options,
                 Path& path) {
  RelaxationTask task{options, &path, {}};
  relax(problem, {&task, 1});
  return task.result;
}

}  // namespace carnot::internal
