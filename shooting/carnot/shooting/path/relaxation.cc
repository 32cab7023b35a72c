#include "carnot/shooting/path/relaxation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "carnot/shooting/linear/chain_least_squares.h"
#include "carnot/shooting/path/middles.h"
#include "carnot/shooting/problem/walls.h"

namespace carnot::internal {
namespace {

// What all intervals share.
struct Transcription {
  const Dynamics& dynamics;
  double h;
  double rho;
  double ceiling;  // c > V; used where the scene has a potential
  bool potential;
  bool walled;  // the path is in one chart, and kept there
  const Walls& walls;
  const RelaxationOptions& options;

  [[nodiscard]] int terms() const {
    return dynamics.dof + dynamics.transcribed + (potential ? 1 : 0);
  }
  [[nodiscard]] int residuals() const { return terms() + walls.size(); }
};

constexpr int kLanes = Middles::kLanes;
static_assert(kLanes == kChainLanes);

// Residuals sqrt(h) r, sqrt(h rho) (G v - lambda / rho) and, with a potential, sqrt(2 h (c - V)) of
// kLanes intervals side by side; keeps room for what it needs on the way.
class Intervals {
 public:
  explicit Intervals(const Transcription& shared)
      : shared_(shared),
        middles_(shared.dynamics.dof),
        terms_((shared.dynamics.dof + shared.dynamics.transcribed + 1) * kLanes),
        derivative_(terms_.size() * 2 * shared.dynamics.dof),
        at_(shared.dynamics.dof),
        s_(shared.walls.size()),
        gradients_(s_.size() * shared.dynamics.dof) {}

  // At the nodes from q on, with the multipliers from lambda on; see chain_least_squares.h.
  bool evaluate(
      int count, const double* lambda, const double* q, double* residuals, double* jacobian) {
    const int n = shared_.dynamics.dof;
    for (int l = 0; shared_.walled && l < count; ++l) {
      if (!same_chart(shared_.dynamics, q + l * n, q + (l + 1) * n)) return false;
    }
    middles_.set(q, count, shared_.h);
    const auto derivative = jacobian != nullptr ? derivative_ : std::span<double>();
    if (!shared_.dynamics.midpoints(middles_.q(), middles_.v(), terms_, derivative)) return false;
    const double per_h = 1 / shared_.h;
    Row sums{};  // zero where all numbers are finite
    for (int row = 0; row < shared_.terms(); ++row) {
      const Row weights = scale(row, count, lambda, residuals + row * kLanes);
      for (int l = 0; l < kLanes; ++l) sums[l] += 0 * (weights[l] + residuals[row * kLanes + l]);
      if (jacobian == nullptr) continue;
      const double* d = &derivative[row * 2 * n * kLanes];
      double* to = jacobian + row * 2 * n * kLanes;
      for (int i = 0; i < n; ++i) {
        for (int l = 0; l < kLanes; ++l) {
          const double by_q = 0.5 * weights[l] * d[i * kLanes + l];
          const double by_v = weights[l] * per_h * d[(n + i) * kLanes + l];
          to[i * kLanes + l] = by_q - by_v;
          to[(n + i) * kLanes + l] = by_q + by_v;
        }
      }
    }
    if (sums != Row{}) return false;
    for (int l = 0; shared_.walls.size() > 0 && l < count; ++l) add_walls(l, residuals, jacobian);
    return true;
  }

 private:
  using Row = std::array<double, kLanes>;

  // Sets residual `row` of all intervals from the terms, returns d residual / d term.
  Row scale(int row, int count, const double* lambda, double* residuals) const {
    const int n = shared_.dynamics.dof;
    const int k = shared_.dynamics.transcribed;
    const double* terms = &terms_[row * kLanes];
    Row weights;
    if (row < n) {
      weights.fill(std::sqrt(shared_.h));
      for (int l = 0; l < kLanes; ++l) residuals[l] = weights[l] * terms[l];
    } else if (row < n + k) {
      const double per_rho = 1 / shared_.rho;
      weights.fill(std::sqrt(shared_.h * shared_.rho));
      for (int l = 0; l < kLanes; ++l) {
        const double multiplier = lambda[std::min(l, count - 1) * k + row - n];
        residuals[l] = weights[l] * (terms[l] - multiplier * per_rho);
      }
    } else {
      for (int l = 0; l < kLanes; ++l) {
        residuals[l] = std::sqrt(2 * shared_.h * (shared_.ceiling - terms[l]));
        weights[l] = -shared_.h / residuals[l];
      }
    }
    return weights;
  }

  // The last residuals of interval l: what is beyond each wall.
  void add_walls(int l, double* residuals, double* jacobian) {
    const int n = shared_.dynamics.dof;
    for (int j = 0; j < n; ++j) at_[j] = middles_.q()[j * kLanes + l];
    shared_.walls.evaluate(
        at_.data(), s_.data(), jacobian != nullptr ? gradients_.data() : nullptr, nullptr);
    for (int w = 0; w < shared_.walls.size(); ++w) {
      const int row = shared_.terms() + w;
      const double weight =
          std::sqrt(shared_.h * shared_.options.wall_rate) / shared_.options.wall_sizes[w];
      const bool beyond = s_[w] < 0;
      residuals[row * kLanes + l] = beyond ? weight * s_[w] : 0;
      if (jacobian == nullptr) continue;
      double* to = jacobian + row * 2 * n * kLanes + l;
      for (int i = 0; i < n; ++i) {
        to[i * kLanes] = to[(n + i) * kLanes] = beyond ? 0.5 * weight * gradients_[w * n + i] : 0;
      }
    }
  }

  const Transcription& shared_;
  Middles middles_;
  std::vector<double> terms_;
  std::vector<double> derivative_;
  std::vector<double> at_;
  std::vector<double> s_;
  std::vector<double> gradients_;
};

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

}  // namespace

Relaxation relax(const BoundaryValueProblem& problem,
                 const RelaxationOptions& options,
                 Path& path) {
  const Dynamics& dynamics = problem.dynamics;
  const double h = problem.time / path.intervals;
  PathTerms state = terms_of(dynamics, h, path);
  const double spread = 1 + std::abs(state.max_potential);
  const Walls walls(problem.limits, dynamics.dof);
  Transcription shared{dynamics,
                       h,
                       options.penalty * state.mass,
                       state.max_potential + spread,
                       state.potential,
                       in_one_chart(dynamics, path),
                       walls,
                       options};
  path.lambda.resize(static_cast<std::size_t>(path.intervals) * dynamics.transcribed, 0.0);
  std::vector<double>& lambda = path.lambda;

  Relaxation result;
  if (state.constraint.size() != lambda.size() || !std::isfinite(state.action)) return result;
  Intervals intervals(shared);
  const int k = dynamics.transcribed;
  const ChainResiduals residuals =
      [&](int first, int count, const double* q, double* values, double* jacobian) {
        return intervals.evaluate(count, lambda.data() + first * k, q, values, jacobian);
      };
  ChainOptions inner;
  inner.max_iterations = options.inner_iterations;
  inner.radius = 1 / options.caution;
  inner.free_first = problem.free_from;
  inner.free_last = problem.free_to;
  for (int outer = 0; outer < options.outer_iterations; ++outer) {
    result.iterations += minimise_chain(residuals, shared.residuals(), dynamics.dof, inner, path.q);
    state = terms_of(dynamics, h, path);
    if (state.constraint.size() != lambda.size()) break;
    for (std::size_t i = 0; i < lambda.size(); ++i) lambda[i] -= shared.rho * state.constraint[i];
    if (state.violation < options.feasibility) break;
  }
  result.action = state.action;
  result.violation = state.violation;
  result.feasible = state.violation < options.feasibility;
  return result;
}

}  // namespace carnot::internal
