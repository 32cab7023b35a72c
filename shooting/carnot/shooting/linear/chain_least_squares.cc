#include "carnot/shooting/linear/chain_least_squares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/shooting/linear/banded_cholesky.h"
#include "carnot/shooting/linear/norm.h"

namespace carnot::internal {
namespace {

// Which numbers of a chain are unknown: those of the inner nodes, and what is free of the ends.
class ChainEnds {
 public:
  ChainEnds(const ChainOptions& options, int n, int intervals)
      : inner_((intervals - 1) * n), n_(n) {
    for (int j = 0; j < n; ++j) {
      if (!options.free_first.empty() && options.free_first[j]) first_.push_back(j);
      if (!options.free_last.empty() && options.free_last[j]) last_.push_back(n + inner_ + j);
    }
  }

  [[nodiscard]] bool free() const { return !first_.empty() || !last_.empty(); }
  [[nodiscard]] int first() const { return static_cast<int>(first_.size()); }
  [[nodiscard]] int inner() const { return inner_; }
  [[nodiscard]] int size() const { return first() + inner_ + static_cast<int>(last_.size()); }
  // Where unknown `j` stands in the chain,
  [[nodiscard]] int place(int j) const {
    if (j < first()) return first_[j];
    j -= first();
    return j < inner_ ? n_ + j : last_[j - inner_];
  }
  // and which unknown stands at `place`; -1: none.
  [[nodiscard]] int unknown(int place) const {
    if (place >= n_ && place < n_ + inner_) return first() + place - n_;
    const std::vector<int>& end = place < n_ ? first_ : last_;
    const auto found = std::find(end.begin(), end.end(), place);
    if (found == end.end()) return -1;
    return static_cast<int>(found - end.begin()) + (place < n_ ? 0 : first() + inner_);
  }

 private:
  std::vector<int> first_;
  std::vector<int> last_;
  int inner_;
  int n_;
};

// |r|^2 / 2 along a chain, its gradient J'r and J'J.
class Chain {
 public:
  Chain(const ChainResiduals& residuals_of,
        int residuals,
        int n,
        const ChainOptions& options,
        std::size_t nodes)
      : residuals_of_(residuals_of),
        n_(n),
        intervals_(static_cast<int>(nodes) - 1),
        ends_(options, n, intervals_),
        size_(ends_.size()),
        normal_(size_, 2 * n - 1),
        gradient_(size_),
        r_(static_cast<std::size_t>(residuals) * kChainLanes),
        jacobian_(r_.size() * 2 * n),
        products_(static_cast<std::size_t>(2 * n) * 2 * n * kChainLanes),
        slopes_(static_cast<std::size_t>(2 * n) * kChainLanes) {}

  [[nodiscard]] int size() const { return size_; }
  // x + step.
  void move(const std::vector<double>& x,
            const std::vector<double>& step,
            std::vector<double>& to) const {
    const double* own = &step[ends_.first()];
    for (int j = 0; j < ends_.inner(); ++j) to[n_ + j] = x[n_ + j] + own[j];
    for (int j = 0; ends_.free() && j < size_; ++j)
      to[ends_.place(j)] = x[ends_.place(j)] + step[j];
  }
  // |x| of the nodes that move.
  [[nodiscard]] double size_of(const std::vector<double>& x) const {
    const double inner = norm({&x[n_], static_cast<std::size_t>(ends_.inner())});
    if (!ends_.free()) return inner;
    double square = inner * inner;
    for (int j = 0; j < size_; ++j) {
      const bool at_end = j < ends_.first() || j >= ends_.first() + ends_.inner();
      if (at_end) square += x[ends_.place(j)] * x[ends_.place(j)];
    }
    return std::sqrt(square);
  }

  // Infinite where there are no residuals.
  [[nodiscard]] double cost(const std::vector<double>& x) {
    double sum = 0;
    for (int i = 0; i < intervals_; i += kChainLanes) {
      const int count = std::min(kChainLanes, intervals_ - i);
      if (!residuals_of_(i, count, &x[i * n_], r_.data(), nullptr)) return kNone;
      sum += sum_of_squares(count);
    }
    return std::isfinite(sum) ? 0.5 * sum : kNone;
  }

  // The same with derivatives.
  [[nodiscard]] double linearise(const std::vector<double>& x) {
    normal_.clear();
    std::fill(gradient_.begin(), gradient_.end(), 0.0);
    double sum = 0;
    for (int i = 0; i < intervals_; i += kChainLanes) {
      const int count = std::min(kChainLanes, intervals_ - i);
      if (!residuals_of_(i, count, &x[i * n_], r_.data(), jacobian_.data())) return kNone;
      sum += sum_of_squares(count);
      multiply();
      for (int l = 0; l < count; ++l) add(i + l, l);
    }
    return std::isfinite(sum) ? 0.5 * sum : kNone;
  }

  [[nodiscard]] const BandedCholesky& normal() const { return normal_; }
  [[nodiscard]] double diagonal(int j) { return normal_(j, j); }
  [[nodiscard]] const std::vector<double>& gradient() const { return gradient_; }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  // Of the first `count` intervals that stand side by side.
  [[nodiscard]] double sum_of_squares(int count) const {
    double sum = 0;
    for (std::size_t r = 0; r < r_.size(); r += kChainLanes) {
      for (int l = 0; l < count; ++l) sum += r_[r + l] * r_[r + l];
    }
    return sum;
  }

  // J'r and J'J of the intervals that stand side by side.
  void multiply() {
    const int columns = 2 * n_;
    const std::size_t rows = r_.size() / kChainLanes;
    const auto entry = [&](std::size_t row, int column) {
      return &jacobian_[(row * columns + column) * kChainLanes];
    };
    // Lane by lane in memory of its own, so that the compiler may keep the sums in registers.
    const auto sum_products = [&](const auto& left, const auto& right, double* to) {
      std::array<double, kChainLanes> sums{};
      for (std::size_t row = 0; row < rows; ++row) {
        const double* x = left(row);
        const double* y = right(row);
        for (int l = 0; l < kChainLanes; ++l) sums[l] += x[l] * y[l];
      }
      std::copy(sums.begin(), sums.end(), to);
    };
    for (int a = 0; a < columns; ++a) {
      const auto column = [&](std::size_t row) { return entry(row, a); };
      sum_products(
          column,
          [&](std::size_t row) { return &r_[row * kChainLanes]; },
          &slopes_[a * kChainLanes]);
      for (int b = a; b < columns; ++b) {
        sum_products(
            column,
            [&](std::size_t row) { return entry(row, b); },
            &products_[(a * columns + b) * kChainLanes]);
      }
    }
  }

  // What interval i, number l of those side by side, adds to the normal equations.
  void add(int i, int l) {
    const int first = i == 0 ? n_ : 0;  // of its 2n arguments that are free
    const int last = i + 1 == intervals_ ? n_ : 2 * n_;
    const int shift = ends_.first() + (i - 1) * n_;
    if (ends_.free() && (i == 0 || i + 1 == intervals_)) return add_beside_end(i, l);
    for (int a = first; a < last; ++a) {
      gradient_[shift + a] += slopes_[a * kChainLanes + l];
      double* normal = &normal_(shift + a, shift + a);
      const double* products = &products_[(a * 2 * n_ + a) * kChainLanes + l];
      for (int b = 0; b < last - a; ++b) normal[b] += products[b * kChainLanes];
    }
  }

  // The same where a node may be free in part.
  void add_beside_end(int i, int l) {
    for (int a = 0; a < 2 * n_; ++a) {
      const int at = ends_.unknown(i * n_ + a);
      if (at < 0) continue;
      gradient_[at] += slopes_[a * kChainLanes + l];
      for (int b = a; b < 2 * n_; ++b) {
        const int other = ends_.unknown(i * n_ + b);
        if (other >= 0) normal_(at, other) += products_[(a * 2 * n_ + b) * kChainLanes + l];
      }
    }
  }

  const ChainResiduals& residuals_of_;
  int n_;
  int intervals_;
  ChainEnds ends_;
  int size_;
  BandedCholesky normal_;
  std::vector<double> gradient_;
  // Of kChainLanes intervals side by side: r, J, J'J and J'r.
  std::vector<double> r_;
  std::vector<double> jacobian_;
  std::vector<double> products_;
  std::vector<double> slopes_;
};

double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

// How far the linear model is trusted.
struct TrustRegion {
  double radius;
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

// Squares of the units of the columns.
std::vector<double> units2(Chain& chain) {
  std::vector<double> units(chain.size());
  for (int j = 0; j < chain.size(); ++j) {
    const double unit = 1 / (1 + std::sqrt(chain.diagonal(j)));
    units[j] = unit * unit;
  }
  return units;
}

// (J'J + D) step = -J'r.
class DampedStep {
 public:
  explicit DampedStep(const Chain& chain) : damped_(chain.normal()), damping_(chain.size()) {}

  // Returns the gain that the linear model predicts; 0 where it cannot tell.
  double solve(Chain& chain,
               const std::vector<double>& unit2,
               double radius,
               std::vector<double>& step) {
    constexpr double kLeastDiagonal = 1e-6;
    constexpr double kLargestDiagonal = 1e32;
    damped_ = chain.normal();
    for (int j = 0; j < chain.size(); ++j) {
      const double scaled = chain.diagonal(j) * unit2[j];
      damping_[j] = std::clamp(scaled, kLeastDiagonal, kLargestDiagonal) / (radius * unit2[j]);
      damped_(j, j) += damping_[j];
      step[j] = -chain.gradient()[j];
    }
    if (!damped_.factor()) return 0;
    damped_.substitute(step);
    double gain = 0;
    for (int j = 0; j < chain.size(); ++j) {
      gain += 0.5 * step[j] * (damping_[j] * step[j] - chain.gradient()[j]);
    }
    return std::isfinite(gain) ? gain : 0;
  }

 private:
  BandedCholesky damped_;
  std::vector<double> damping_;
};

}  // namespace

int minimise_chain(const ChainResiduals& residuals_of,
                   int residuals,
                   int n,
                   const ChainOptions& options,
                   std::vector<double>& x) {
  constexpr double kLeastRatio = 1e-3;  // of true to predicted gain
  Chain chain(residuals_of, residuals, n, options, x.size() / n);
  double cost = chain.linearise(x);
  if (chain.size() == 0 || !std::isfinite(cost)) return 0;
  const std::vector<double> unit2 = units2(chain);
  DampedStep damped(chain);
  std::vector<double> step(chain.size());
  std::vector<double> trial = x;
  TrustRegion region{options.radius};
  int iterations = 0;
  bool done = false;
  while (!done && iterations < options.max_iterations && std::isfinite(cost) &&
         largest(chain.gradient()) > options.gradient_tolerance) {
    ++iterations;
    const double predicted = damped.solve(chain, unit2, region.radius, step);
    if (!(predicted > 0)) {
      region.reject();
      continue;
    }
    chain.move(x, step, trial);
    const double gain = cost - chain.cost(trial);
    const double size = chain.size_of(x) + options.step_tolerance;
    done = std::abs(gain) <= options.function_tolerance * cost ||
           norm(step) <= options.step_tolerance * size;
    if (!(gain > kLeastRatio * predicted)) {
      region.reject();
      continue;
    }
    region.accept(gain / predicted);
    x = trial;
    if (!done) cost = chain.linearise(x);
  }
  return iterations;
}

}  // namespace carnot::internal
