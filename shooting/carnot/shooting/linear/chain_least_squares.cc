#include "carnot/shooting/linear/chain_least_squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/linear/banded_lanes.h"
#include "carnot/shooting/linear/lanes.h"

namespace carnot::internal {
namespace {

static_assert(kChainLanes == kLanes);

// Which numbers of a chain are unknown: those of the inner nodes, and what is free of the ends.
class ChainEnds {
 public:
  ChainEnds(const ChainOptions& options, const ChainShape& shape)
      : inner_((shape.intervals - 1) * shape.n), n_(shape.n) {
    for (int j = 0; j < n_; ++j) {
      if (!options.free_first.empty() && options.free_first[j]) first_.push_back(j);
      if (!options.free_last.empty() && options.free_last[j]) last_.push_back(n_ + inner_ + j);
    }
  }

  [[nodiscard]] int size() const {
    return static_cast<int>(first_.size()) + inner_ + static_cast<int>(last_.size());
  }
  // Where unknown `j` stands in the chain,
  [[nodiscard]] int place(int j) const {
    const int first = static_cast<int>(first_.size());
    if (j < first) return first_[j];
    j -= first;
    return j < inner_ ? n_ + j : last_[j - inner_];
  }
  // and which unknown stands at `place`; -1: none.
  [[nodiscard]] int unknown(int place) const {
    const int first = static_cast<int>(first_.size());
    if (place >= n_ && place < n_ + inner_) return first + place - n_;
    const std::vector<int>& end = place < n_ ? first_ : last_;
    const auto found = std::find(end.begin(), end.end(), place);
    if (found == end.end()) return -1;
    return static_cast<int>(found - end.begin()) + (place < n_ ? 0 : first + inner_);
  }

 private:
  std::vector<int> first_;
  std::vector<int> last_;
  int inner_;
  int n_;
};

// |r|^2 / 2 along chains, its gradient J'r and J'J, at nodes of their own.
struct Model {
  Model(int nodes, int size, int width) : x(nodes), gradient(size), normal(size, width), cost() {}

  std::vector<Lanes> x;
  std::vector<Lanes> gradient;
  BandedLanes normal;
  Lanes cost;  // infinite where there are no residuals

  // Becomes `other` in the lanes of the mask.
  void take(const LanePack::Mask& mask, const Model& other) {
    take_lanes(mask, other.x, x);
    take_lanes(mask, other.gradient, gradient);
    normal.take(mask, other.normal);
    cost.set(select(mask, other.cost.pack(), cost.pack()));
  }
};

// Sets models at their nodes.
class Chains {
 public:
  Chains(const ChainResiduals& residuals_of, const ChainShape& shape, const ChainOptions& options)
      : residuals_of_(residuals_of),
        shape_(shape),
        ends_(options, shape),
        residual_(shape.residuals),
        jacobian_(static_cast<std::size_t>(shape.residuals) * 2 * shape.n + kTogether) {
    for (int i = 0; i < (shape.intervals + 1) * shape.n; ++i) unknown_.push_back(ends_.unknown(i));
    for (int j = 0; j < ends_.size(); ++j) place_.push_back(ends_.place(j));
  }

  [[nodiscard]] int size() const { return ends_.size(); }
  [[nodiscard]] Model model() const {
    return {(shape_.intervals + 1) * shape_.n, size(), 2 * shape_.n};
  }
  // Where unknown `j` stands in the chain.
  [[nodiscard]] int place(int j) const { return place_[j]; }

  // Sets the model at its nodes.
  void linearise(Model& model) {
    const int n = shape_.n;
    LanePack sum(0);
    for (int i = 0; i < shape_.intervals; ++i) {
      residuals_of_(i, model.x[i * n].data(), residual_[0].data(), jacobian_[0].data());
      LanePack own(0);
      for (const Lanes& r : residual_) own += r.pack() * r.pack();
      sum += own;
      for (int a = 0; a < 2 * n; ++a) {
        if (unknown_[i * n + a] >= 0) add_column(i, a, model);
      }
    }
    (LanePack(0.5) * sum).store(model.cost.data());
    for (double& cost : model.cost.at) {
      if (!std::isfinite(cost)) cost = std::numeric_limits<double>::infinity();
    }
  }

 private:
  // Columns whose sums stay in registers.
  static constexpr int kTogether = 4;

  // What column a of the Jacobian of interval i adds to the normal equations: products with those
  // that are not before it. Each interval is the first to write what has to do with its last node.
  void add_column(int i, int a, Model& model) const {
    const int n = shape_.n;
    const int* const unknown = &unknown_[i * n];
    const int known = i == 0 ? 0 : n;  // columns whose sums have begun
    const int at = unknown[a];
    Lanes* const to = &model.normal(at, at);
    for (int first = a; first < 2 * n; first += kTogether) {
      LanePack slope(0);
      std::array<LanePack, kTogether> sums;
#pragma GCC unroll 8
      for (LanePack& x : sums) x = LanePack(0);
      const Lanes* own = &jacobian_[a];
      const Lanes* others = &jacobian_[first];
      for (int row = 0; row < shape_.residuals; ++row) {
        const LanePack x = own->pack();
        slope += x * residual_[row].pack();
#pragma GCC unroll 8
        for (int b = 0; b < kTogether; ++b) sums[b] += x * others[b].pack();
        own += 2 * n;
        others += 2 * n;
      }
      if (first == a) put(slope, a < known, model.gradient[at]);
#pragma GCC unroll 8
      for (int b = 0; b < kTogether; ++b) {
        const int column = first + b;
        if (column < 2 * n && unknown[column] >= 0) {
          put(sums[b], column < known, to[unknown[column] - at]);
        }
      }
    }
  }
  static void put(const LanePack& x, bool begun, Lanes& to) { to.set(begun ? to.pack() + x : x); }

  const ChainResiduals& residuals_of_;
  ChainShape shape_;
  ChainEnds ends_;
  std::vector<int> unknown_;
  std::vector<int> place_;
  std::vector<Lanes> residual_;
  std::vector<Lanes> jacobian_;
};

// How far the linear model is trusted.
struct TrustRegion {
  double radius = 0;
  double shrink = 2;

  // After a step whose true gain was `ratio` of the predicted one.
  void accept(double ratio) {
    constexpr double kLargest = 1e16;
    radius = std::min(kLargest, radius / std::max(1.0 / 3, 1 - std::pow(2 * ratio - 1, 3)));
    shrink = 2;
  }
  void reject() {
    radius /= shrink;
    shrink *= 2;
  }
};

// Where the chain of a lane stands.
struct Lane {
  bool busy = false;   // there is one,
  bool fresh = false;  // and nothing is known of it yet
  bool moved = false;  // the trial is a step away
  int iterations = 0;
  TrustRegion region;
};

class Minimisation {
 public:
  Minimisation(const ChainResiduals& residuals_of,
               const ChainShape& shape,
               const ChainOptions& options,
               const NextChain& next)
      : options_(options),
        next_(next),
        chains_(residuals_of, shape, options),
        current_(chains_.model()),
        trial_(chains_.model()),
        damped_(current_.normal),
        damping_(chains_.size()),
        unit2_(chains_.size()),
        step_(chains_.size()),
        nodes_(current_.x.size()) {}

  void run() {
    for (int l = 0; l < kLanes; ++l) take_next(l);
    fill_idle();
    trial_.x = current_.x;
    while (any_busy()) {
      chains_.linearise(trial_);
      judge();
      set_units();
      for (int l = 0; l < kLanes; ++l) {
        if (lanes_[l].busy && is_done(l)) take_next(l);
      }
      if (any_busy()) step();
    }
  }

 private:
  [[nodiscard]] bool any_busy() const {
    return std::any_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.busy; });
  }

  // Hands over what lane l has come to, and takes the next chain.
  void take_next(int l) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = current_.x[i].at[l];
    const double radius = next_(l, lanes_[l].iterations, nodes_);
    lanes_[l] = {};
    lanes_[l].busy = lanes_[l].fresh = radius > 0;
    lanes_[l].region.radius = radius;
    for (std::size_t i = 0; lanes_[l].busy && i < nodes_.size(); ++i) {
      current_.x[i].at[l] = nodes_[i];
    }
  }

  // Lanes that never have a chain repeat another one: no time is lost on numbers without sense.
  void fill_idle() {
    const auto busy =
        std::find_if(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.busy; });
    if (busy == lanes_.end()) return;
    const auto from = busy - lanes_.begin();
    for (int l = 0; l < kLanes; ++l) {
      for (Lanes& x : current_.x) {
        if (!lanes_[l].busy) x.at[l] = x.at[from];
      }
    }
  }

  // Takes the trials that gain enough.
  void judge() {
    constexpr double kLeastRatio = 1e-3;  // of true to predicted gain
    ChosenLanes chosen;
    bool all = true;
    for (int l = 0; l < kLanes; ++l) {
      Lane& lane = lanes_[l];
      finished_[l] = false;
      chosen[l] = lane.fresh;
      if (lane.busy && lane.moved) {
        const double cost = current_.cost.at[l];
        const double gain = cost - trial_.cost.at[l];
        const double size = std::sqrt(size2_.at[l]) + options_.step_tolerance;
        finished_[l] = std::abs(gain) <= options_.function_tolerance * cost ||
                       std::sqrt(step2_.at[l]) <= options_.step_tolerance * size;
        chosen[l] = gain > kLeastRatio * predicted_.at[l];
        if (chosen[l]) {
          lane.region.accept(gain / predicted_.at[l]);
        } else {
          lane.region.reject();
        }
      }
      all = all && (chosen[l] || !lane.busy);
    }
    if (all) {
      std::swap(current_, trial_);
    } else {
      current_.take(chosen.mask(), trial_);
    }
  }

  // Squares of the units of the columns, where a chain begins.
  void set_units() {
    ChosenLanes fresh;
    bool any = false;
    for (int l = 0; l < kLanes; ++l) any = (fresh[l] = lanes_[l].fresh) || any;
    if (!any) return;
    const LanePack::Mask mask = fresh.mask();
    for (int j = 0; j < chains_.size(); ++j) {
      const LanePack unit = LanePack(1) / (LanePack(1) + sqrt(current_.normal(j, j).pack()));
      unit2_[j].set(select(mask, unit * unit, unit2_[j].pack()));
    }
  }

  // Whether the chain of a lane is minimised, or cannot be.
  [[nodiscard]] bool is_done(int l) {
    Lane& lane = lanes_[l];
    lane.fresh = false;
    if (finished_[l] || lane.iterations >= options_.max_iterations) return true;
    if (chains_.size() == 0 || !std::isfinite(current_.cost.at[l])) return true;
    double largest = 0;
    for (const Lanes& slope : current_.gradient) {
      largest = std::max(largest, std::abs(slope.at[l]));
    }
    return !(largest > options_.gradient_tolerance);
  }

  // (J'J + D) step = -J'r in all lanes, and the gain that the linear model predicts.
  void step() {
    constexpr double kLeastDiagonal = 1e-6;
    constexpr double kLargestDiagonal = 1e32;
    Lanes radius;
    for (int l = 0; l < kLanes; ++l) radius.at[l] = lanes_[l].fresh ? 1 : lanes_[l].region.radius;
    for (int j = 0; j < chains_.size(); ++j) {
      const LanePack unit2 = unit2_[j].pack();
      const LanePack scaled = current_.normal(j, j).pack() * unit2;
      const LanePack bounded =
          min(max(scaled, LanePack(kLeastDiagonal)), LanePack(kLargestDiagonal));
      damping_[j].set(bounded / (radius.pack() * unit2));
      step_[j].set(-current_.gradient[j].pack());
    }
    const Lanes definite(damped_.factor(current_.normal, damping_));
    damped_.substitute(step_);
    LanePack gain(0);
    for (int j = 0; j < chains_.size(); ++j) {
      const LanePack x = step_[j].pack();
      gain += LanePack(0.5) * x * (damping_[j].pack() * x - current_.gradient[j].pack());
    }
    predicted_.set(gain);
    ChosenLanes moved;
    for (int l = 0; l < kLanes; ++l) {
      Lane& lane = lanes_[l];
      lane.moved = false;
      if (!lane.busy || lane.fresh) continue;
      ++lane.iterations;
      const double predicted = predicted_.at[l];
      moved[l] = lane.moved = definite.at[l] > 0 && predicted > 0 && std::isfinite(predicted);
      if (!lane.moved) lane.region.reject();
    }
    move(moved.mask());
  }

  void move(const LanePack::Mask& moved) {
    LanePack step2(0);
    LanePack size2(0);
    trial_.x = current_.x;
    for (int j = 0; j < chains_.size(); ++j) {
      const int at = chains_.place(j);
      const LanePack x = current_.x[at].pack();
      const LanePack step = select(moved, step_[j].pack(), LanePack(0));
      step2 += step * step;
      size2 += x * x;
      trial_.x[at].set(x + step);
    }
    step2_.set(step2);
    size2_.set(size2);
  }

  const ChainOptions& options_;
  const NextChain& next_;
  Chains chains_;
  std::array<Lane, kLanes> lanes_{};
  Model current_;
  Model trial_;
  BandedLanes damped_;
  std::vector<Lanes> damping_;
  std::vector<Lanes> unit2_;
  std::vector<Lanes> step_;
  Lanes predicted_;
  Lanes step2_;  // squares of |step| and of |x|, of what moves
  Lanes size2_;
  std::array<bool, kLanes> finished_{};  // the last step changed little
  std::vector<double> nodes_;            // of one lane
};

}  // namespace

void minimise_chains(const ChainResiduals& residuals_of,
                     const ChainShape& shape,
                     const ChainOptions& options,
                     const NextChain& next) {
  Minimisation(residuals_of, shape, options, next).run();
}

}  // namespace carnot::internal
