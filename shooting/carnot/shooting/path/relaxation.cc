#include "carnot/shooting/path/relaxation.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "carnot/shooting/linear/chain_least_squares.h"
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

// Residuals sqrt(h) r, sqrt(h rho) (G v - lambda / rho) and, with a potential, sqrt(2 h (c - V)) of
// one interval; keeps room for what it needs on the way.
class Interval {
 public:
  explicit Interval(const Transcription& shared)
      : shared_(shared),
        qm_(shared.dynamics.dof),
        v_(shared.dynamics.dof),
        terms_(shared.dynamics.dof + shared.dynamics.transcribed + 1),
        derivative_(terms_.size() * 2 * shared.dynamics.dof),
        s_(shared.walls.size()),
        gradients_(s_.size() * shared.dynamics.dof) {}

  // At the nodes q, 2n numbers; see chain_least_squares.h.
  bool evaluate(const double* lambda, const double* q, double* residuals, double* jacobian) {
    const int n = shared_.dynamics.dof;
    if (shared_.walled && !same_chart(shared_.dynamics, q, q + n)) return false;
    for (int i = 0; i < n; ++i) {
      qm_[i] = 0.5 * (q[i] + q[n + i]);
      v_[i] = (q[n + i] - q[i]) / shared_.h;
    }
    const auto derivative = jacobian != nullptr ? derivative_ : std::span<double>();
    if (!shared_.dynamics.midpoint(qm_, v_, terms_, derivative)) return false;
    for (int row = 0; row < shared_.terms(); ++row) {
      const double weight = scale(row, lambda, residuals);
      if (!std::isfinite(weight) || !std::isfinite(residuals[row])) return false;
      if (jacobian == nullptr) continue;
      const double* d = &derivative[row * 2 * n];
      double* to = jacobian + row * 2 * n;
      for (int i = 0; i < n; ++i) {
        const double by_q = 0.5 * weight * d[i];
        const double by_v = weight * d[n + i] / shared_.h;
        to[i] = by_q - by_v;
        to[n + i] = by_q + by_v;
      }
    }
    if (shared_.walls.size() > 0) add_walls(residuals, jacobian);
    return true;
  }

 private:
  // Sets residual `row` from the terms, returns d residual / d term.
  double scale(int row, const double* lambda, double* residuals) const {
    const int n = shared_.dynamics.dof;
    if (row < n) {
      const double weight = std::sqrt(shared_.h);
      residuals[row] = weight * terms_[row];
      return weight;
    }
    if (row < n + shared_.dynamics.transcribed) {
      const double weight = std::sqrt(shared_.h * shared_.rho);
      residuals[row] = weight * (terms_[row] - lambda[row - n] / shared_.rho);
      return weight;
    }
    residuals[row] = std::sqrt(2 * shared_.h * (shared_.ceiling - terms_[row]));
    return -shared_.h / residuals[row];
  }

  // The last residuals: what is beyond each wall.
  void add_walls(double* residuals, double* jacobian) {
    const int n = shared_.dynamics.dof;
    shared_.walls.evaluate(
        qm_.data(), s_.data(), jacobian != nullptr ? gradients_.data() : nullptr, nullptr);
    for (int w = 0; w < shared_.walls.size(); ++w) {
      const int row = shared_.terms() + w;
      const double weight =
          std::sqrt(shared_.h * shared_.options.wall_rate) / shared_.options.wall_sizes[w];
      const bool beyond = s_[w] < 0;
      residuals[row] = beyond ? weight * s_[w] : 0;
      if (jacobian == nullptr) continue;
      double* to = jacobian + row * 2 * n;
      for (int i = 0; i < n; ++i) {
        to[i] = to[n + i] = beyond ? 0.5 * weight * gradients_[w * n + i] : 0;
      }
    }
  }

  const Transcription& shared_;
  std::vector<double> qm_;
  std::vector<double> v_;
  std::vector<double> terms_;
  std::vector<double> derivative_;
  std::vector<double> s_;
  std::vector<double> gradients_;
};

// Reads the terms of all intervals of a path.
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
  std::vector<double> qm(n), v(n), terms(n + k + 1);
  double largest_speed = 0;
  double largest_constraint = 0;
  double kinetic = 0;
  double speed = 0;
  for (int i = 0; i < path.intervals; ++i) {
    double v2 = 0;
    for (int j = 0; j < n; ++j) {
      qm[j] = 0.5 * (path.configuration(i)[j] + path.configuration(i + 1)[j]);
      v[j] = (path.configuration(i + 1)[j] - path.configuration(i)[j]) / h;
      v2 += v[j] * v[j];
    }
    if (!dynamics.midpoint(qm, v, terms)) continue;
    double r2 = 0;
    double c2 = 0;
    for (int j = 0; j < n; ++j) r2 += terms[j] * terms[j];
    for (int j = 0; j < k; ++j) c2 += terms[n + j] * terms[n + j];
    result.constraint.insert(result.constraint.end(), terms.begin() + n, terms.begin() + n + k);
    result.action += h * (0.5 * r2 - terms[n + k]);
    kinetic += r2;
    speed += v2;
    largest_speed = std::max(largest_speed, std::sqrt(v2));
    largest_constraint = std::max(largest_constraint, std::sqrt(c2));
    result.max_potential = i == 0 ? terms[n + k] : std::max(result.max_potential, terms[n + k]);
    result.potential = result.potential || terms[n + k] != 0;
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
  Interval interval(shared);
  const int k = dynamics.transcribed;
  const ChainResiduals residuals = [&](int i, const double* q, double* values, double* jacobian) {
    return interval.evaluate(lambda.data() + i * k, q, values, jacobian);
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
  fill_momenta(dynamics, h, path);
  return result;
}

}  // namespace carnot::internal
