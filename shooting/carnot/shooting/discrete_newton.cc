#include "carnot/shooting/discrete_newton.h"

#include <algorithm>
#include <cmath>

#include "carnot/shooting/banded_lu.h"

namespace carnot {
namespace {

// The equations of one path. Unknowns: lambda_0, q_1, lambda_1, ..., q_{K-1}, lambda_{K-1}.
class Equations {
 public:
  Equations(const Segment& segment, double h, int intervals)
      : segment_(segment),
        h_(h),
        n_(segment.dof),
        k_(segment.transcribed),
        intervals_(intervals),
        m_(2 * n_ + k_),
        x_(m_),
        gradient_(m_),
        hessian_(m_ * m_) {}

  [[nodiscard]] int size() const { return intervals_ * k_ + (intervals_ - 1) * n_; }
  [[nodiscard]] int band() const { return 2 * n_ + k_ - 1; }

  // Residual at `path`; fills the matrix too where one is given. Returns the largest momentum.
  double evaluate(const Path& path, std::vector<double>& residual, BandedLu* matrix) {
    residual.assign(size(), 0.0);
    if (matrix != nullptr) matrix->clear();
    double largest = 0;
    for (int i = 0; i < intervals_; ++i) {
      path.gather(i, k_, x_.data());
      segment_.discrete_lagrangian(
          h_, x_.data(), gradient_.data(), matrix != nullptr ? hessian_.data() : nullptr);
      for (int a = 0; a < m_; ++a) {
        if (a < 2 * n_) largest = std::max(largest, std::abs(gradient_[a]));
        const int row = unknown(i, a);
        if (row < 0) continue;
        residual[row] += gradient_[a];
        for (int b = 0; matrix != nullptr && b < m_; ++b) {
          const int column = unknown(i, b);
          if (column >= 0) (*matrix)(row, column) += hessian_[a * m_ + b];
        }
      }
    }
    return largest;
  }

  // path - step * direction.
  void move(const Path& from, const std::vector<double>& direction, double step, Path& to) const {
    to.q = from.q;
    to.lambda = from.lambda;
    for (int i = 0; i < intervals_; ++i) {
      const int start = i * (n_ + k_);
      for (int j = 0; j < k_; ++j) to.lambda[i * k_ + j] -= step * direction[start + j];
      for (int j = 0; j < n_ && i + 1 < intervals_; ++j) {
        to.configuration(i + 1)[j] -= step * direction[start + k_ + j];
      }
    }
  }

 private:
  // Index of argument `a` of interval i among the unknowns; -1 for a fixed end.
  [[nodiscard]] int unknown(int i, int a) const {
    const int start = i * (n_ + k_);
    if (a >= 2 * n_) return start + a - 2 * n_;
    if (a >= n_) return i + 1 == intervals_ ? -1 : start + k_ + a - n_;
    return i == 0 ? -1 : start - n_ + a;
  }

  const Segment& segment_;
  double h_;
  int n_;
  int k_;
  int intervals_;
  int m_;
  std::vector<double> x_;
  std::vector<double> gradient_;
  std::vector<double> hessian_;
};

double norm(const std::vector<double>& x) {
  double sum = 0;
  for (const double value : x) sum += value * value;
  return std::sqrt(sum);
}

}  // namespace

DiscreteNewton tighten(const BoundaryValueProblem& problem,
                       const DiscreteNewtonOptions& options,
                       Path& path) {
  constexpr double kShortestStep = 1.0 / 64;
  // Where no step gains: round-off of coordinates far from zero, magnified near singular frames.
  constexpr double kRoundedOff = 1e-6;
  const double h = problem.time / path.intervals;
  Equations equations(problem.segment, h, path.intervals);
  BandedLu matrix(equations.size(), equations.band(), equations.band());
  std::vector<double> residual;
  std::vector<double> direction;
  std::vector<double> simplified;
  Path trial = path;
  const bool walled = in_one_chart(problem.segment, path);
  DiscreteNewton result;
  const double scale = equations.evaluate(path, residual, &matrix);
  result.residual = norm(residual);
  while (result.iterations < options.max_iterations && std::isfinite(result.residual)) {
    result.converged = result.residual <= options.tolerance * scale;
    if (result.converged) break;
    ++result.iterations;
    if (!matrix.factor()) break;
    direction = residual;
    matrix.substitute(direction);
    const double length = norm(direction);
    double step = 1;
    double reached = 0;
    for (; step >= kShortestStep; step *= 0.5) {
      equations.move(path, direction, step, trial);
      result.left_chart = walled && !in_one_chart(problem.segment, trial);
      if (result.left_chart) continue;
      equations.evaluate(trial, residual, nullptr);
      reached = norm(residual);
      if (reached < (1 - 0.1 * step) * result.residual) break;
      simplified = residual;
      matrix.substitute(simplified);
      if (norm(simplified) < (1 - 0.25 * step) * length) break;
    }
    if (step < kShortestStep) {
      result.converged = !result.left_chart && result.residual <= kRoundedOff * scale;
      break;
    }
    std::swap(path.q, trial.q);
    std::swap(path.lambda, trial.lambda);
    equations.evaluate(path, residual, &matrix);
    result.residual = reached;
  }
  fill_momenta(problem.segment, h, path);
  return result;
}

}  // namespace carnot
