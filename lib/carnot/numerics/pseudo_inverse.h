// Least squares and least norm with a small matrix of any rank.
//
// One-sided Jacobi rotations V make the columns of A orthogonal, A V = W, whose norms are the
// singular values s_j (Hestenes 1958). With w_j, v_j the columns, the pseudo-inverses are
//
//   A^+ b = sum_j v_j (w_j.b) / s_j^2,      (A')^+ c = sum_j w_j (v_j.c) / s_j^2,
//
// over the s_j that are not round-off. Small singular values come with small relative errors where
// A is small only by the scale of its columns, as a frame is that degenerates (Demmel & Veselic
// 1992). Real scalars only, never Jets.
#pragma once

#include <algorithm>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

template <class T, int rows, int cols>
class PseudoInverse {
 public:
  static_assert(!kIsJet<T>, "differentiate the equation instead");

  // A few sweeps over the pairs of columns, about 6 rows flops each.
  explicit PseudoInverse(const Matrix<T, rows, cols>& a)
      : w_(a), v_(Matrix<T, cols, cols>::Identity()) {
    constexpr int kMaxSweeps = 30;  // quadratic convergence: a handful is enough
    for (int sweep = 0; sweep < kMaxSweeps && rotate_all(); ++sweep) {
    }
    T largest(0);
    for (int j = 0; j < cols; ++j) {
      square_[j] = w_.col(j).squaredNorm();
      largest = std::max(largest, square_[j]);
    }
    const T round_off = T(rows + cols) * epsilon<T>();
    for (int j = 0; j < cols; ++j) {
      // A NaN is kept, so that the solution shows it.
      if (!(square_[j] > round_off * round_off * largest) && square_[j] == square_[j]) {
        square_[j] = T(0);
      }
    }
  }

  [[nodiscard]] int rank() const {
    int rank = 0;
    for (int j = 0; j < cols; ++j) rank += square_[j] != T(0) ? 1 : 0;
    return rank;
  }

  // Of all x with the least |A x - b|, the one of least norm.
  [[nodiscard]] Vector<T, cols> solve(const Vector<T, rows>& b) const {
    Vector<T, cols> x = Vector<T, cols>::Zero();
    for (int j = 0; j < cols; ++j) {
      if (square_[j] != T(0)) x += (w_.col(j).dot(b) / square_[j]) * v_.col(j);
    }
    return x;
  }

  // Of all y with the least |A'y - c|, the one of least norm.
  [[nodiscard]] Vector<T, rows> solve_transposed(const Vector<T, cols>& c) const {
    Vector<T, rows> y = Vector<T, rows>::Zero();
    for (int j = 0; j < cols; ++j) {
      if (square_[j] != T(0)) y += (v_.col(j).dot(c) / square_[j]) * w_.col(j);
    }
    return y;
  }

 private:
  // One sweep. False when all columns are orthogonal to round-off.
  bool rotate_all() {
    using std::abs, std::sqrt;
    bool rotated = false;
    for (int i = 0; i < cols; ++i) {
      for (int j = i + 1; j < cols; ++j) {
        const T alpha = w_.col(i).squaredNorm();
        const T beta = w_.col(j).squaredNorm();
        const T gamma = w_.col(i).dot(w_.col(j));
        if (!(abs(gamma) > T(rows) * epsilon<T>() * sqrt(alpha * beta))) continue;
        rotated = true;
        // tan of the angle that makes the pair orthogonal: t^2 + 2 zeta t = 1, the smaller root.
        const T zeta = (beta - alpha) / (T(2) * gamma);
        const T root = abs(zeta) + sqrt(T(1) + zeta * zeta);
        const T tangent = (zeta < T(0) ? T(-1) : T(1)) / root;
        const T cosine = T(1) / sqrt(T(1) + tangent * tangent);
        rotate(w_, i, j, cosine, cosine * tangent);
        rotate(v_, i, j, cosine, cosine * tangent);
      }
    }
    return rotated;
  }

  template <class M>
  static void rotate(M& m, int i, int j, const T& cosine, const T& sine) {
    for (int r = 0; r < m.rows(); ++r) {
      const T left = m(r, i);
      const T right = m(r, j);
      m(r, i) = cosine * left - sine * right;
      m(r, j) = sine * left + cosine * right;
    }
  }

  Matrix<T, rows, cols> w_;
  Matrix<T, cols, cols> v_;
  Vector<T, cols> square_;  // s_j^2, zero where s_j is round-off
};

}  // namespace carnot
