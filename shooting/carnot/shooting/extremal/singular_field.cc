#include "carnot/shooting/extremal/singular_field.h"

#include <cmath>

#include "carnot/shooting/linear/dense.h"
#include "carnot/transcription/transcription_functions.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kFullRank = 1e-9;  // of G, relative to its largest singular value
// Of c, and of its derivatives, for p and directions of length 1 in natural scales: less is zero.
constexpr double kZero = 1e-9;
constexpr double kTold = 1e-7;

}  // namespace

SingularField::SingularField(const Dynamics& dynamics)
    : dynamics_(dynamics), n_(dynamics.dof), k_(dynamics.transcribed), row_(row_length(n_)) {
  entries_.resize(static_cast<std::size_t>(entry_count(*dynamics.transcription)) * row_);
}

bool SingularField::suits(const Dynamics& dynamics, const VectorXd& q) {
  constexpr int kLeast = 3;  // coordinates
  if (!dynamics.has_transcription() || dynamics.holonomic > 0 || dynamics.dof < kLeast)
    return false;
  return SingularField(dynamics).set(q);
}

bool SingularField::set(const VectorXd& q) {
  if (q_.size() == q.size() && q_ == q) return true;
  q_.resize(0);
  if (!q.allFinite()) return false;
  dynamics_.transcription->entries(dynamics_.system.get(), q.data(), {}, true, entries_.data());
  m_.resize(n_, n_);
  g_.resize(k_, n_);
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j <= i; ++j) m_(i, j) = m_(j, i) = mass(i, j)[0];
  }
  for (int a = 0; a < k_; ++a) {
    for (int j = 0; j < n_; ++j) g_(a, j) = constraint(a, j)[0];
  }
  const RightSingular right = right_singular(g_);
  const int rank = n_ - 2;
  const double least = kFullRank * right.values[0];
  if (!(right.values[rank - 1] > least) || !(right.values[rank] <= least)) return false;
  rows_ = right.vectors.leftCols(rank);
  basis_ = right.vectors.rightCols(2);
  MatrixXd scaled = rows_;
  for (int a = 0; a < rank; ++a) scaled.col(a) /= right.values[a] * right.values[a];
  inverse_ = product(product(scaled, rows_.transpose()), g_.transpose());
  const double* const potential = entries_.data() + entries_.size() - row_;
  for (int i = 0; i < n_; ++i) {
    if (potential[1 + i] != 0) return false;
  }
  q_ = q;
  return true;
}

MatrixXd SingularField::slopes(const VectorXd& lambda) const {
  MatrixXd slopes = MatrixXd::Zero(n_, n_);
  for (int a = 0; a < k_; ++a) {
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) slopes(i, j) += lambda[a] * constraint(a, j)[1 + i];
    }
  }
  return slopes;
}

MatrixXd SingularField::moved(const VectorXd& w) const {
  MatrixXd moved = MatrixXd::Zero(k_, n_);
  for (int a = 0; a < k_; ++a) {
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) moved(a, j) += w[i] * constraint(a, j)[1 + i];
    }
  }
  return moved;
}

MatrixXd SingularField::curvature(const VectorXd& v, const VectorXd& lambda) const {
  // What is even in v, v'M v / 2 among it, is left out.
  const VectorXd back = -v;
  RowMajor there(n_, n_);
  RowMajor opposite(n_, n_);
  const auto hessian = [&](const VectorXd& velocity, RowMajor& l_qq) {
    dynamics_.transcription->hessian(
        dynamics_.system.get(), q_.data(), velocity.data(), lambda.data(), {}, l_qq.data());
  };
  hessian(v, there);
  hessian(back, opposite);
  return -0.5 * (there - opposite);
}

MatrixXd SingularField::covectors(const VectorXd& q) {
  if (!set(q)) return MatrixXd::Zero(n_, 0);
  const auto count = static_cast<int>(rows_.cols());
  MatrixXd bracket(1, count);  // c of each
  for (int a = 0; a < count; ++a) {
    const MatrixXd s = slopes(transposed_product(inverse_, rows_.col(a)));
    const MatrixXd w = s - s.transpose();
    bracket(0, a) = basis_.col(0).dot(product(w, basis_.col(1)).col(0));
  }
  if (bracket.norm() <= kZero) return rows_;
  return product(rows_, right_singular(bracket).vectors.rightCols(count - 1));
}

std::optional<SingularField::Rate> SingularField::rate(const VectorXd& q, const VectorXd& p) {
  if (!set(q)) return std::nullopt;
  const VectorXd lambda = transposed_product(inverse_, p);
  const MatrixXd s = slopes(lambda);
  const MatrixXd w = s - s.transpose();
  double by[2];  // D_1 c and D_2 c
  const VectorXd b1 = basis_.col(0);
  const VectorXd b2 = basis_.col(1);
  const MatrixXd q1 = curvature(b1, lambda);
  const MatrixXd q2 = curvature(b2, lambda);
  for (int j = 0; j < 2; ++j) {
    const VectorXd b = basis_.col(j);
    const VectorXd turned = product(w, b);
    const MatrixXd s_dot = slopes(transposed_product(inverse_, turned));
    const MatrixXd basis_dot = -product(inverse_, product(moved(b), basis_));
    by[j] = b1.dot(product(s_dot - s_dot.transpose(), b2).col(0));
    by[j] += b1.dot(product(q2, b).col(0)) - b2.dot(product(q1, b).col(0));
    by[j] += basis_dot.col(0).dot(product(w, b2).col(0)) + b1.dot(product(w, basis_dot).col(1));
  }
  if (!(std::hypot(by[0], by[1]) > kTold * p.norm())) return std::nullopt;
  Rate rate;
  rate.velocity = by[1] * b1 - by[0] * b2;
  rate.velocity /= std::sqrt(rate.velocity.dot(momentum(q, rate.velocity)));
  rate.force = product(s, rate.velocity);
  if (!rate.velocity.allFinite() || !rate.force.allFinite()) return std::nullopt;
  return rate;
}

SingularField::Drive SingularField::drive(const VectorXd& q,
                                          const VectorXd& velocity,
                                          const MatrixXd& columns) {
  Drive drive{columns, MatrixXd::Constant(2, columns.cols(), std::nan(""))};
  if (!set(q)) return drive;
  MatrixXd beside = columns;  // p - M v
  beside.col(0) -= momentum(q, velocity);
  drive.violations = transposed_product(basis_, beside);
  for (int a = 0; a < columns.cols(); ++a) {
    const MatrixXd s = slopes(transposed_product(inverse_, beside.col(a)));
    drive.force.col(a) = product(s, velocity);
  }
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < n_; ++j) {
      const double* const entry = i >= j ? mass(i, j) : mass(j, i);
      for (int d = 0; d < n_; ++d) {
        drive.force(d, 0) += 0.5 * velocity[i] * velocity[j] * entry[1 + d];
      }
    }
  }
  return drive;
}

MatrixXd SingularField::annihilator(const VectorXd& q) { return set(q) ? rows_ : MatrixXd(n_, 0); }

double SingularField::violation(const VectorXd& q, const VectorXd& velocity) {
  return set(q) ? product(g_, velocity).cwiseAbs().maxCoeff() : std::nan("");
}

VectorXd SingularField::momentum(const VectorXd& q, const VectorXd& velocity) {
  if (!set(q)) return VectorXd::Constant(n_, std::nan(""));
  return product(m_, velocity);
}

}  // namespace carnot::internal
