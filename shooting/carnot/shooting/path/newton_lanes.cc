#include "carnot/shooting/path/newton_lanes.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "carnot/shooting/linear/banded_lanes.h"
#include "carnot/shooting/linear/lanes.h"
#include "carnot/shooting/path/newton_step.h"

namespace carnot::internal {
namespace {

static_assert(Dynamics::kMidpointLanes == kLanes);

// Paths with multipliers, one in each lane.
struct PathLanes {
  PathLanes(int n, int k, int intervals)
      : q(static_cast<std::size_t>(intervals + 1) * n),
        lambda(static_cast<std::size_t>(intervals) * k) {}

  std::vector<Lanes> q;
  std::vector<Lanes> lambda;

  void set(int l, const Path& path) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i].at[l] = path.q[i];
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i].at[l] = path.lambda[i];
  }
  void get(int l, Path& path) const {
    for (std::size_t i = 0; i < q.size(); ++i) path.q[i] = q[i].at[l];
    for (std::size_t i = 0; i < lambda.size(); ++i) path.lambda[i] = lambda[i].at[l];
  }
  void take(const LanePack::Mask& mask, const PathLanes& other) {
    take_lanes(mask, other.q, q);
    take_lanes(mask, other.lambda, lambda);
  }
};

// The equations of discrete_equations.h at paths of their own. Newton's step solves
//
//   H dq + A' dlambda = r,   A dq = s.
//
// Pivots of H may vanish, as those of coordinates without mass do. So H + sigma A'A takes the place
// of H, and r + sigma A's that of r; the solution is the same. In each interval sigma makes both
// summands of one size. Where rows of G depend on each other lambda has a block of its own, and
// sigma is zero.
struct Linearisation {
  Linearisation(int size, int width, int intervals)
      : residual(size), matrix(size, width), weight(intervals) {}

  std::vector<Lanes> residual;
  BandedLanes matrix;
  std::vector<Lanes> weight;  // sigma of each interval
  Lanes norm;
  Lanes largest;  // momentum

  void take(const LanePack::Mask& mask, const Linearisation& other) {
    take_lanes(mask, other.residual, residual);
    matrix.take(mask, other.matrix);
    take_lanes(mask, other.weight, weight);
    norm.set(select(mask, other.norm.pack(), norm.pack()));
    largest.set(select(mask, other.largest.pack(), largest.pack()));
  }
};

Lanes norms(const std::vector<Lanes>& x) {
  LanePack sum(0);
  for (const Lanes& value : x) sum += value.pack() * value.pack();
  return Lanes(sqrt(sum));
}

class EquationLanes {
 public:
  EquationLanes(const BoundaryValueProblem& problem, int intervals)
      : dynamics_(problem.dynamics),
        h_(problem.time / intervals),
        n_(dynamics_.dof),
        k_(dynamics_.transcribed),
        m_(2 * n_ + k_),
        intervals_(intervals),
        x_(static_cast<std::size_t>(m_) * kLanes),
        gradient_(x_.size()),
        hessian_(x_.size() * m_) {
    // The unknown that each number of a node is, and each multiplier.
    std::vector<int> of_node;
    std::vector<int> of_multiplier;
    for (int i = 0; i <= intervals; ++i) {
      for (int j = 0; j < n_; ++j) {
        const bool free = i == 0           ? problem.is_free_from(j)
                          : i == intervals ? problem.is_free_to(j)
                                           : true;
        of_node.push_back(free ? size_++ : -1);
      }
      for (int j = 0; i > 0 && j < k_; ++j) of_multiplier.push_back(size_++);
    }
    for (int i = 0; i < intervals; ++i) {
      unknown_.insert(unknown_.end(), &of_node[i * n_], &of_node[i * n_] + 2 * n_);
      for (int j = 0; j < k_; ++j) unknown_.push_back(of_multiplier[i * k_ + j]);
    }
  }

  [[nodiscard]] Linearisation linearisation() const { return {size_, 2 * (n_ + k_), intervals_}; }

  // Sets the residual, and the matrix too where it is wanted.
  void evaluate(const PathLanes& at, bool second, Linearisation& to) {
    LanePack largest(0);
    for (int i = 0; i < intervals_; ++i) {
      for (int j = 0; j < 2 * n_; ++j) at.q[i * n_ + j].pack().store(&x_[j * kLanes]);
      for (int j = 0; j < k_; ++j) at.lambda[i * k_ + j].pack().store(&x_[(2 * n_ + j) * kLanes]);
      dynamics_.discrete_lagrangians(
          h_, x_, gradient_, second ? std::span<double>(hessian_) : std::span<double>());
      for (int a = 0; a < 2 * n_; ++a) {
        largest = max(largest, abs(LanePack::load(&gradient_[a * kLanes])));
      }
      add_slopes(i, to);
      if (second) add_matrix(i, to);
    }
    to.norm = norms(to.residual);
    to.largest.set(largest);
  }

  // The right-hand side that belongs to the matrix of `of`, for this residual.
  void combine(const Linearisation& of,
               const std::vector<Lanes>& residual,
               std::vector<Lanes>& combined) const {
    combined = residual;
    for (int i = 0; i < intervals_; ++i) {
      const int* const unknown = &unknown_[i * m_];
      for (int c = 2 * n_; c < m_; ++c) {
        const LanePack weighed = of.weight[i].pack() * residual[unknown[c]].pack();
        for (int a = 0; a < 2 * n_; ++a) {
          if (unknown[a] < 0) continue;
          combined[unknown[a]].add(weighed * of.matrix(unknown[a], unknown[c]).pack());
        }
      }
    }
  }

  // path - step * direction in the lanes of the mask; the path itself in others.
  void move(const PathLanes& from,
            const std::vector<Lanes>& direction,
            const LanePack& step,
            const LanePack::Mask& mask,
            PathLanes& to) const {
    const auto move = [&](const Lanes& x, int unknown, Lanes& moved) {
      if (unknown < 0) {
        moved = x;
      } else {
        const LanePack there = x.pack() - step * direction[unknown].pack();
        moved.set(select(mask, there, x.pack()));
      }
    };
    for (int j = 0; j < n_; ++j) move(from.q[j], unknown_[j], to.q[j]);
    for (int i = 0; i < intervals_; ++i) {
      const int* const unknown = &unknown_[i * m_];
      for (int j = 0; j < n_; ++j) {
        const int at = (i + 1) * n_ + j;
        move(from.q[at], unknown[n_ + j], to.q[at]);
      }
      for (int j = 0; j < k_; ++j) {
        const int at = i * k_ + j;
        move(from.lambda[at], unknown[2 * n_ + j], to.lambda[at]);
      }
    }
  }

 private:
  // What interval i adds. It is the first to write what has to do with its last node, or with its
  // multipliers.
  void add_slopes(int i, Linearisation& to) const {
    const int* const unknown = &unknown_[i * m_];
    for (int a = 0; a < m_; ++a) {
      if (unknown[a] < 0) continue;
      put(LanePack::load(&gradient_[a * kLanes]), i > 0 && a < n_, to.residual[unknown[a]]);
    }
  }
  void add_matrix(int i, Linearisation& to) const {
    const int* const unknown = &unknown_[i * m_];
    const LanePack weight = weight_of_constraints();
    to.weight[i].set(weight);
    for (int a = 0; a < m_; ++a) {
      const int row = unknown[a];
      if (row < 0) continue;
      Lanes* const entries = &to.matrix(row, row);
      for (int b = a; b < m_; ++b) {
        if (unknown[b] < 0) continue;
        LanePack entry = hessian(a, b);
        for (int c = 2 * n_; b < 2 * n_ && c < m_; ++c) {
          entry += weight * hessian(c, a) * hessian(c, b);
        }
        put(entry, i > 0 && b < n_, entries[unknown[b] - row]);
      }
    }
  }
  static void put(const LanePack& x, bool begun, Lanes& sum) {
    sum.set(begun ? sum.pack() + x : x);
  }
  [[nodiscard]] LanePack hessian(int a, int b) const {
    return LanePack::load(&hessian_[(a * m_ + b) * kLanes]);
  }
  // sigma, see above; of a gauge, zero.
  [[nodiscard]] LanePack weight_of_constraints() const {
    LanePack size(0);
    LanePack square(0);
    for (int a = 0; a < 2 * n_; ++a) {
      size += abs(hessian(a, a));
      for (int c = 2 * n_; c < m_; ++c) square += hessian(c, a) * hessian(c, a);
    }
    return k_ < n_ ? size / square : LanePack(0);
  }

  const Dynamics& dynamics_;
  double h_;
  int n_;
  int k_;
  int m_;
  int intervals_;
  int size_ = 0;
  std::vector<int> unknown_;  // that the arguments (q_i, q_{i+1}, lambda_i) of each interval are
  std::vector<double> x_;
  std::vector<double> gradient_;
  std::vector<double> hessian_;
};

// After so many trials in vain a path goes on alone: many of these come to nothing, and take so
// long that the other lanes would be idle. Measured on starts to random targets, in us for each,
// with 2, 5 and 9 trials and without end: bicycle 127, 115, 115 and 131; trailer2 178, 163, 161 and
// 160; satellite 113, 118, 123 and 170; grushin 65, 70, 75 and 120. With the vehicle all are alike.
constexpr int kMostRefused = 5;

// Where the path of a lane stands.
struct NewtonLane {
  TighteningTask* task = nullptr;
  bool fresh = false;   // nothing is known of it yet
  bool walled = false;  // it is in one chart, and kept there
  double scale = 0;
  double step = 1;
  double length = 0;  // of Newton's step
  int refused = 0;    // trials
};

class NewtonLanes {
 public:
  NewtonLanes(const BoundaryValueProblem& problem,
              const DiscreteNewtonOptions& options,
              std::span<TighteningTask> tasks)
      : problem_(problem),
        options_(options),
        waiting_(tasks),
        scratch_(*tasks.front().path),
        equations_(problem, scratch_.intervals),
        current_(problem.dynamics.dof, problem.dynamics.transcribed, scratch_.intervals),
        trial_(current_),
        at_current_(equations_.linearisation()),
        at_trial_(at_current_),
        factors_(at_current_.matrix),
        direction_(at_current_.residual.size()),
        nothing_(at_current_.residual.size()),
        simplified_(at_current_.residual.size()) {}

  void run() {
    for (int l = 0; l < kLanes; ++l) {
      if (!take_next(l)) current_.set(l, scratch_);
    }
    trial_ = current_;
    while (any_busy()) {
      const bool second = any_full_step();
      equations_.evaluate(trial_, second, at_trial_);
      judge();
      if (any_chosen()) {
        if (!second) equations_.evaluate(trial_, true, at_trial_);
        take_chosen();
      }
      for (int l = 0; l < kLanes; ++l) {
        if (lanes_[l].task != nullptr && ends(l)) finish(l);
      }
      if (any_busy()) step();
    }
  }

 private:
  [[nodiscard]] bool any_busy() const {
    return std::any_of(
        lanes_.begin(), lanes_.end(), [](const NewtonLane& lane) { return lane.task != nullptr; });
  }

  // Whether a trial is likely to be taken, so that its matrix is worth its time: steps that were
  // halved often are halved again.
  [[nodiscard]] bool any_full_step() const {
    return std::any_of(lanes_.begin(), lanes_.end(), [](const NewtonLane& lane) {
      return lane.task != nullptr && (lane.fresh || lane.step == 1);
    });
  }
  [[nodiscard]] bool any_chosen() const {
    return std::any_of(chosen_.lane.begin(), chosen_.lane.end(), [](bool lane) { return lane; });
  }

  bool take_next(int l) {
    lanes_[l] = {};
    if (waiting_.empty()) return false;
    TighteningTask& task = waiting_.front();
    waiting_ = waiting_.subspan(1);
    assert(task.path->intervals == scratch_.intervals);
    lanes_[l].task = &task;
    lanes_[l].fresh = true;
    lanes_[l].walled = in_one_chart(problem_.dynamics, *task.path);
    task.result = {};
    current_.set(l, *task.path);
    return true;
  }

  // Hands over what the path of a lane has become, and takes the next one.
  void finish(int l) {
    Path& path = *lanes_[l].task->path;
    current_.get(l, path);
    fill_momenta(problem_.dynamics, problem_.time / path.intervals, path);
    take_next(l);
  }

  // Takes the trials that are better, and halves the steps of others.
  void judge() {
    bool shortened = false;  // whether the simplified steps are known
    Lanes simplified;
    ChosenLanes chosen;
    for (int l = 0; l < kLanes; ++l) {
      NewtonLane& lane = lanes_[l];
      if (lane.task == nullptr) continue;
      if (lane.fresh) {
        chosen[l] = true;
        lane.fresh = false;
        lane.scale = at_trial_.largest.at[l];
        continue;
      }
      DiscreteNewton& result = lane.task->result;
      result.left_chart = lane.walled && leaves_chart(l);
      bool better = false;
      if (!result.left_chart) {
        better = makes_fall(lane.step, result.residual, at_trial_.norm.at[l]);
        if (!better && !shortened) {
          equations_.combine(at_current_, at_trial_.residual, simplified_);
          factors_.substitute(simplified_);
          simplified = norms(simplified_);
          shortened = true;
        }
        better = better || makes_shorter(lane.step, lane.length, simplified.at[l]);
      }
      chosen[l] = better;
      lane.step = better ? 1 : 0.5 * lane.step;
      lane.refused += better ? 0 : 1;
    }
    chosen_ = chosen;
  }

  void take_chosen() {
    bool all = true;
    for (int l = 0; l < kLanes; ++l) {
      if (chosen_[l]) lanes_[l].task->result.residual = at_trial_.norm.at[l];
      all = all && (chosen_[l] || lanes_[l].task == nullptr);
    }
    if (all) {
      std::swap(current_, trial_);
      std::swap(at_current_, at_trial_);
    } else {
      current_.take(chosen_.mask(), trial_);
      at_current_.take(chosen_.mask(), at_trial_);
    }
    factored_ = false;
  }

  bool leaves_chart(int l) {
    trial_.get(l, scratch_);
    return !in_one_chart(problem_.dynamics, scratch_);
  }

  // Whether the iteration of a lane ends where it is.
  bool ends(int l) {
    NewtonLane& lane = lanes_[l];
    DiscreteNewton& result = lane.task->result;
    if (!chosen_[l]) {
      if (lane.refused > kMostRefused) {
        go_on_alone(l);
        return true;
      }
      if (lane.step >= kShortestStep) return false;
      result.converged = !result.left_chart && result.residual <= kRoundedOff * lane.scale;
      return true;
    }
    result.converged = result.residual <= options_.tolerance * lane.scale;
    return result.converged || !std::isfinite(result.residual) ||
           result.iterations >= options_.max_iterations;
  }

  // The path of a lane where it is, tightened on by discrete_newton.h.
  void go_on_alone(int l) {
    DiscreteNewton& result = lanes_[l].task->result;
    current_.get(l, scratch_);
    DiscreteNewtonOptions options = options_;
    options.max_iterations -= result.iterations;
    options.scale = lanes_[l].scale;
    const int before = result.iterations;
    result = tighten(problem_, options, scratch_);
    result.iterations += before;
    current_.set(l, scratch_);
  }

  // Newton's steps of the paths that moved, and the next trials of all.
  void step() {
    // Half of the digits, and some that the iteration mends. Of 480 starts each of twelve scenes,
    // 11 of bicycle, 10 of satellite, 2 of engel and none of the others get there.
    constexpr double kLargestMultiplier = 1e9;
    if (!factored_) {
      (void)factors_.factor(at_current_.matrix, nothing_);
      largest_.set(factors_.largest_multiplier());
      equations_.combine(at_current_, at_current_.residual, direction_);
      factors_.substitute(direction_);
      length_ = norms(direction_);
      factored_ = true;
    }
    Lanes steps;
    ChosenLanes moved;
    for (int l = 0; l < kLanes; ++l) {
      NewtonLane& lane = lanes_[l];
      if (lane.task == nullptr || lane.fresh) continue;
      if (chosen_[l]) {
        ++lane.task->result.iterations;
        lane.length = length_.at[l];
      }
      if (!(largest_.at[l] < kLargestMultiplier)) {
        *lane.task = {lane.task->path, tighten(problem_, options_, *lane.task->path)};
        take_next(l);
        continue;
      }
      steps.at[l] = lane.step;
      moved[l] = true;
    }
    equations_.move(current_, direction_, steps.pack(), moved.mask(), trial_);
  }

  const BoundaryValueProblem& problem_;
  const DiscreteNewtonOptions& options_;
  std::span<TighteningTask> waiting_;
  Path scratch_;  // of one lane
  EquationLanes equations_;
  std::array<NewtonLane, kLanes> lanes_{};
  ChosenLanes chosen_;  // whose trial was taken
  PathLanes current_;
  PathLanes trial_;
  Linearisation at_current_;
  Linearisation at_trial_;
  // Of the current paths, once they are factored: the largest multipliers, and Newton's steps.
  bool factored_ = false;
  BandedLanes factors_;
  Lanes largest_;
  std::vector<Lanes> direction_;
  Lanes length_;
  std::vector<Lanes> nothing_;  // is added to the diagonal
  std::vector<Lanes> simplified_;
};

}  // namespace

void tighten(const BoundaryValueProblem& problem,
             const DiscreteNewtonOptions& options,
             std::span<TighteningTask> tasks) {
  assert(problem.dynamics.has_transcription());
  if (!tasks.empty()) NewtonLanes(problem, options, tasks).run();
}

}  // namespace carnot::internal
