// Cholesky factors without pivots, for small positive definite matrices over any scalar.
//
// A = L D L' with L unit lower triangular and D diagonal: no square roots, no branches on data but
// the check of the pivots, so the same text serves every scalar. On Jets nothing is factored in a
// solve: with A x = b the implicit function theorem gives A dx = db - dA x, so the values are
// factored once and each derivative is one more solve.
// (Eigen's decompositions must not be instantiated on Jets: their triangular solver skips entries
// whose value is zero and with them the derivatives.)
#pragma once

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/round_off.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// L (strictly below the diagonal) and the pivots D of the lower triangle of `a`. Returns false when
// `a` is not positive definite to round-off, or not finite. Straight-line: differentiable on Jets.
template <class T, int n>
[[nodiscard]] bool cholesky_factor(const Matrix<T, n, n>& a,
                                   Matrix<T, n, n>& lower,
                                   Vector<T, n>& pivots) {
  const T threshold = constant<T>(pivot_round_off<Real<T>>(n));
  bool positive = true;
  for (int j = 0; j < n; ++j) {
    T pivot = a(j, j);
    for (int k = 0; k < j; ++k) pivot -= lower(j, k) * lower(j, k) * pivots[k];
    positive = positive && all(pivot > threshold * a(j, j)) && all(pivot > constant<T>(0));
    pivots[j] = pivot;
    const T inverse = constant<T>(1) / pivot;
    for (int i = j + 1; i < n; ++i) {
      T sum = a(i, j);
      for (int k = 0; k < j; ++k) sum -= lower(i, k) * lower(j, k) * pivots[k];
      lower(i, j) = sum * inverse;
    }
  }
  return positive;
}

template <class T, int n>
class Cholesky {
 public:
  // Factors the lower triangle of `a`. Cost about n^3 / 6 multiplications, n divisions. Two by two,
  // the second pivot is written as determinant over a_00, so that no division waits for another.
  explicit Cholesky(const Matrix<T, n, n>& a) : lower_(a) {
    if constexpr (n == 2) {
      const T product = a(0, 0) * a(1, 1);
      const T determinant = product - a(1, 0) * a(1, 0);
      positive_ =
          all(a(0, 0) > constant<T>(0)) && all(determinant > constant<T>(kThreshold) * product);
      inverses_[1] = a(0, 0) / determinant;
      inverses_[0] = constant<T>(1) / a(0, 0);
      lower_(1, 0) = a(1, 0) * inverses_[0];
    } else {
      Vector<T, n> pivots;
      positive_ = cholesky_factor(a, lower_, pivots);
      for (int i = 0; i < n; ++i) inverses_[i] = constant<T>(1) / pivots[i];
    }
  }

  // False when the matrix is not positive definite to round-off, or not finite.
  [[nodiscard]] bool positive() const { return positive_; }

  [[nodiscard]] Vector<T, n> solve(const Vector<T, n>& b) const {
    Vector<T, n> x = b;
    for (int i = 1; i < n; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= lower_(i, k) * x[k];
    }
    for (int i = 0; i < n; ++i) x[i] *= inverses_[i];
    for (int i = n - 2; i >= 0; --i) {
      for (int k = i + 1; k < n; ++k) x[i] -= lower_(k, i) * x[k];
    }
    return x;
  }

 private:
  static constexpr Real<T> kThreshold = pivot_round_off<Real<T>>(n);
  Matrix<T, n, n> lower_;
  Vector<T, n> inverses_;  // 1/D: one division a pivot, the slowest of operations
  bool positive_;
};

// On Jets: values are factored, derivatives follow from A dx = db - dA x.
template <class T, int N, int n>
class Cholesky<Jet<T, N>, n> {
 public:
  explicit Cholesky(const Matrix<Jet<T, N>, n, n>& a) : a_(a), values_(primal(a)) {}

  [[nodiscard]] bool positive() const { return values_.positive(); }

  [[nodiscard]] Vector<Jet<T, N>, n> solve(const Vector<Jet<T, N>, n>& b) const {
    Vector<T, n> value;
    for (int i = 0; i < n; ++i) value[i] = b[i].a;
    const Vector<T, n> x = values_.solve(value);
    Vector<Jet<T, N>, n> result;
    for (int i = 0; i < n; ++i) result[i].a = x[i];
    for (int d = 0; d < N; ++d) {
      Vector<T, n> rhs;
      for (int i = 0; i < n; ++i) {
        rhs[i] = b[i].v[d];
        for (int j = 0; j < n; ++j) rhs[i] -= (i >= j ? a_(i, j) : a_(j, i)).v[d] * x[j];
      }
      const Vector<T, n> dx = values_.solve(rhs);
      for (int i = 0; i < n; ++i) result[i].v[d] = dx[i];
    }
    return result;
  }

 private:
  Matrix<Jet<T, N>, n, n> a_;
  Cholesky<T, n> values_;
};

}  // namespace carnot
