// Least squares and least norm with a small matrix of any rank.
//
// The rotations V of jacobi_rotations.h make the columns of A orthogonal, A V = W, whose norms are
// the singular values s_j. With w_j, v_j the columns, the pseudo-inverses are
//
//   A^+ b = sum_j v_j (w_j.b) / s_j^2,      (A')^+ c = sum_j w_j (v_j.c) / s_j^2,
//
// over the s_j that are not round-off. Small ones keep their digits where A is small only by the
// scale of its columns, as a frame is that degenerates. Real scalars only, never Jets.
#pragma once

#include <algorithm>

#include "carnot/numerics/jacobi_rotations.h"
#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// Sizes may be Eigen::Dynamic.
template <class T, int rows, int cols>
class PseudoInverse {
 public:
  explicit PseudoInverse(const Matrix<T, rows, cols>& a)
      : w_(a), v_(Matrix<T, cols, cols>::Identity(a.cols(), a.cols())), square_(a.cols()) {
    const int row_count = static_cast<int>(a.rows());
    const int count = static_cast<int>(a.cols());
    static_cast<void>(orthogonalise_columns(row_count, count, w_.data(), v_.data()));
    T largest(0);
    for (int j = 0; j < count; ++j) {
      square_[j] = T(0);
      for (int i = 0; i < row_count; ++i) square_[j] += w_(i, j) * w_(i, j);
      largest = std::max(largest, square_[j]);
    }
    const T round_off = T(row_count + count) * epsilon<T>();
    for (int j = 0; j < count; ++j) {
      // A NaN is kept, so that the solution shows it.
      if (!(square_[j] > round_off * round_off * largest) && square_[j] == square_[j]) {
        square_[j] = T(0);
      }
    }
  }

  [[nodiscard]] int rank() const {
    int rank = 0;
    for (int j = 0; j < square_.size(); ++j) rank += square_[j] != T(0) ? 1 : 0;
    return rank;
  }

  // Of all x with the least |A x - b|, the one of least norm.
  [[nodiscard]] Vector<T, cols> solve(const Vector<T, rows>& b) const { return combine(w_, b, v_); }

  // Of all y with the least |A'y - c|, the one of least norm.
  [[nodiscard]] Vector<T, rows> solve_transposed(const Vector<T, cols>& c) const {
    return combine(v_, c, w_);
  }

 private:
  // sum_j to_j (from_j.b) / s_j^2, with a column for each j.
  template <int in, int out>
  Vector<T, out> combine(const Matrix<T, in, cols>& from,
                         const Vector<T, in>& b,
                         const Matrix<T, out, cols>& to) const {
    Vector<T, out> sum(to.rows());
    for (int i = 0; i < sum.size(); ++i) sum[i] = T(0);
    for (int j = 0; j < square_.size(); ++j) {
      if (square_[j] == T(0)) continue;
      T along(0);
      for (int i = 0; i < from.rows(); ++i) along += from(i, j) * b[i];
      for (int i = 0; i < sum.size(); ++i) sum[i] += along / square_[j] * to(i, j);
    }
    return sum;
  }

  Matrix<T, rows, cols> w_;
  Matrix<T, cols, cols> v_;
  Vector<T, cols> square_;  // s_j^2, zero where s_j is round-off
};

}  // namespace carnot
