#include "carnot/shooting/path/discrete_equations.h"

#include <algorithm>
#include <array>
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
      middles_(n_),
      terms_(static_cast<std::size_t>(n_ + k_ + 1) * kLanes),
      by_middle_(terms_.size() * 2 * n_),
      slopes_(static_cast<std::size_t>(2 * n_ * n_) * kLanes) {
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
    for (int j = 0; j < n_ && !dynamics_.has_transcription(); ++j) {
      largest = std::max(largest, std::abs(terms.x[n_ + j] - terms.x[j]));
    }
    for (int a = 0; a < 2 * n_; ++a) largest = std::max(largest, std::abs(terms.gradient[a]));
    if (i > 0 && i + 1 < intervals_ && (matrix == nullptr || weights.hessian == 1)) {
      add_between(i, terms, residual, matrix);
    } else {
      add(i, terms, weights.hessian, residual, matrix);
    }
  });
  if (matrix != nullptr && weights.metric != 0) add_metric(path, weights.metric, *matrix);
  return largest;
}

void DiscreteEquations::add(int i,
                            const PathLagrangian::Terms& terms,
                            double weight_of_hessian,
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
      if (a < 2 * n_ && b < 2 * n_) entry *= weight_of_hessian;
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
    const PathLagrangian::Numbers row = terms.hessian.part(a * m_, m_);
    for (int b = 0; b < n_; ++b) to[b] += row[b];
    for (int b = 0; b < k_; ++b) to[n_ + b] += row[2 * n_ + b];
    for (int b = 0; b < n_; ++b) to[n_ + k_ + b] += row[n_ + b];
  }
}

void DiscreteEquations::add_metric(const Path& path, double share, BandedLu& matrix) {
  const int columns = 2 * n_;
  for (int first = 0, count = 0; first < intervals_; first += count) {
    count = set_slopes(path, first);
    for (int a = 0; a < columns; ++a) {
      for (int b = a; b < columns; ++b) {
        std::array<double, kLanes> sums{};
        for (int r = 0; r < n_; ++r) {
          const double* const by_a = &slopes_[(r * columns + a) * kLanes];
          const double* const by_b = &slopes_[(r * columns + b) * kLanes];
          for (int l = 0; l < kLanes; ++l) sums[l] += by_a[l] * by_b[l];
        }
        for (int l = 0; l < count; ++l) {
          const int row = unknown(first + l, a);
          const int column = unknown(first + l, b);
          if (row < 0 || column < 0) continue;
          const double entry = share * h_ * sums[l];
          matrix(row, column) += entry;
          if (a != b) matrix(column, row) += entry;
        }
      }
    }
  }
}

void DiscreteEquations::metric_product(const Path& path,
                                       const std::vector<double>& x,
                                       std::vector<double>& product) {
  product.assign(size(), 0.0);
  for (int first = 0, count = 0; first < intervals_; first += count) {
    count = set_slopes(path, first);
    for (int l = 0; l < count; ++l) {
      for (int r = 0; r < n_; ++r) {
        const double* const row = &slopes_[r * 2 * n_ * kLanes + l];
        double sum = 0;
        for (int a = 0; a < 2 * n_; ++a) {
          if (const int at = unknown(first + l, a); at >= 0) sum += row[a * kLanes] * x[at];
        }
        for (int a = 0; a < 2 * n_; ++a) {
          const int at = unknown(first + l, a);
          if (at >= 0) product[at] += h_ * sum * row[a * kLanes];
        }
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

int DiscreteEquations::set_slopes(const Path& path, int first) {
  const int count = std::min(kLanes, intervals_ - first);
  middles_.set(path.configuration(first), count, h_);
  if (!dynamics_.midpoints(middles_.q(), middles_.v(), terms_, by_middle_)) {
    std::fill(slopes_.begin(), slopes_.end(), std::numeric_limits<double>::quiet_NaN());
    return count;
  }
  const double per_h = 1 / h_;
  for (int r = 0; r < n_; ++r) {
    const double* const by_q = &by_middle_[r * 2 * n_ * kLanes];
    const double* const by_v = by_q + n_ * kLanes;
    double* const left = &slopes_[r * 2 * n_ * kLanes];
    double* const right = left + n_ * kLanes;
    for (int j = 0; j < n_ * kLanes; ++j) {
      left[j] = 0.5 * by_q[j] - per_h * by_v[j];
      right[j] = 0.5 * by_q[j] + per_h * by_v[j];
    }
  }
  return count;
}

}  // namespace carnot::internal
