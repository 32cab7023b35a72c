#include "carnot/shooting/path/discrete_equations.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace carnot::internal {

DiscreteEquations::DiscreteEquations(const BoundaryValueProblem& problem,
                                     int intervals,
                                     double drift)
    : dynamics_(problem.dynamics),
      lagrangian_(dynamics_, problem.time / intervals, drift),
      h_(problem.time / intervals),
      n_(dynamics_.dof),
      k_(PathLagrangian::multipliers(dynamics_)),
      intervals_(intervals),
      free_from_(n_, -1),
      free_to_(n_, -1),
      m_(2 * n_ + k_),
      unknowns_(m_),
      middle_(n_),
      velocity_(n_),
      terms_(n_ + k_ + 1),
      by_middle_(terms_.size() * 2 * n_),
      slopes_(2 * n_ * n_) {
  for (int j = 0; j < n_; ++j) {
    if (problem.is_free_from(j)) free_from_[j] = first_++;
  }
  for (int j = 0; j < n_; ++j) {
    if (problem.is_free_to(j)) free_to_[j] = first_ + inner() + last_++;
  }
}

double DiscreteEquations::evaluate(const Path& path,
                                   std::vector<double>& residual,
                                   BandedLu* matrix,
                                   const Weights& weights) {
  residual.assign(size(), 0.0);
  if (matrix != nullptr) matrix->clear();
  double largest = 0;
  lagrangian_.visit(path, matrix != nullptr, [&](int i, const PathLagrangian::Terms& terms) {
    if (matrix != nullptr && weights.metric != 0) set_slopes(path, i);
    for (int j = 0; j < n_ && !dynamics_.has_transcription(); ++j) {
      largest = std::max(largest, std::abs(terms.x[n_ + j] - terms.x[j]));
    }
    for (int a = 0; a < 2 * n_; ++a) largest = std::max(largest, std::abs(terms.gradient[a]));
    const bool plain = weights.hessian == 1 && weights.metric == 0;
    if (i > 0 && i + 1 < intervals_ && (matrix == nullptr || plain)) {
      add_between(i, terms, residual, matrix);
    } else {
      add(i, terms, weights, residual, matrix);
    }
  });
  return largest;
}

void DiscreteEquations::add(int i,
                            const PathLagrangian::Terms& terms,
                            const Weights& weights,
                            std::vector<double>& residual,
                            BandedLu* matrix) {
  for (int a = 0; a < m_; ++a) unknowns_[a] = unknown(i, a);
  for (int a = 0; a < m_; ++a) {
    const int row = unknowns_[a];
    if (row < 0) continue;
    residual[row] += terms.gradient[a];
    for (int b = 0; matrix != nullptr && b < m_; ++b) {
      const int column = unknowns_[b];
      if (column < 0) continue;
      double entry = terms.hessian[a * m_ + b];
      if (a < 2 * n_ && b < 2 * n_) {
        entry *= weights.hessian;
        if (weights.metric != 0) {
          double sum = 0;
          for (int r = 0; r < n_; ++r) sum += slopes_[r * 2 * n_ + a] * slopes_[r * 2 * n_ + b];
          entry += weights.metric * h_ * sum;
        }
      }
      (*matrix)(row, column) += entry;
    }
  }
}

void DiscreteEquations::add_between(int i,
                                    const PathLagrangian::Terms& terms,
                                    std::vector<double>& residual,
                                    BandedLu* matrix) const {
  // The unknowns q_i, lambda_i and q_{i+1} follow each other.
  const int first = first_ + i * (n_ + k_) - n_;
  const auto argument = [&](int place) {
    if (place < n_) return place;
    return place < n_ + k_ ? n_ + place : place - k_;
  };
  for (int place = 0; place < m_; ++place) {
    const int a = argument(place);
    residual[first + place] += terms.gradient[a];
    if (matrix == nullptr) continue;
    double* const to = &(*matrix)(first + place, first);
    const double* const from = &terms.hessian[a * m_];
    for (int b = 0; b < n_; ++b) to[b] += from[b];
    for (int b = 0; b < k_; ++b) to[n_ + b] += from[2 * n_ + b];
    for (int b = 0; b < n_; ++b) to[n_ + k_ + b] += from[n_ + b];
  }
}

void DiscreteEquations::metric_product(const Path& path,
                                       const std::vector<double>& x,
                                       std::vector<double>& product) {
  product.assign(size(), 0.0);
  for (int i = 0; i < intervals_; ++i) {
    set_slopes(path, i);
    for (int r = 0; r < n_; ++r) {
      const double* row = &slopes_[r * 2 * n_];
      double sum = 0;
      for (int a = 0; a < 2 * n_; ++a) {
        if (const int at = unknown(i, a); at >= 0) sum += row[a] * x[at];
      }
      for (int a = 0; a < 2 * n_; ++a) {
        if (const int at = unknown(i, a); at >= 0) product[at] += h_ * sum * row[a];
      }
    }
  }
}

void DiscreteEquations::move(const Path& from,
                             const std::vector<double>& direction,
                             double step,
                             Path& to) const {
  to.q = from.q;
  to.lambda = from.lambda;
  for (int i = 0; i < intervals_; ++i) {
    const int start = first_ + i * (n_ + k_);
    for (int j = 0; j < k_; ++j) to.lambda[i * k_ + j] -= step * direction[start + j];
    for (int j = 0; j < n_ && i + 1 < intervals_; ++j) {
      to.configuration(i + 1)[j] -= step * direction[start + k_ + j];
    }
  }
  for (int j = 0; j < n_; ++j) {
    if (free_from_[j] >= 0) to.configuration(0)[j] -= step * direction[free_from_[j]];
    if (free_to_[j] >= 0) to.configuration(intervals_)[j] -= step * direction[free_to_[j]];
  }
}

void DiscreteEquations::set_slopes(const Path& path, int i) {
  for (int j = 0; j < n_; ++j) {
    middle_[j] = 0.5 * (path.configuration(i)[j] + path.configuration(i + 1)[j]);
    velocity_[j] = (path.configuration(i + 1)[j] - path.configuration(i)[j]) / h_;
  }
  if (!dynamics_.midpoint(middle_, velocity_, terms_, by_middle_)) {
    std::fill(slopes_.begin(), slopes_.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (int r = 0; r < n_; ++r) {
    const double* row = &by_middle_[r * 2 * n_];
    for (int j = 0; j < n_; ++j) {
      slopes_[r * 2 * n_ + j] = 0.5 * row[j] - row[n_ + j] / h_;
      slopes_[r * 2 * n_ + n_ + j] = 0.5 * row[j] + row[n_ + j] / h_;
    }
  }
}

}  // namespace carnot::internal
