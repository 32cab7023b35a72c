// How far apart two lists of numbers, or two matrices, are. Loops, since the compiler takes several
// times as long for what Eigen makes of an expression.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot::test {

// The largest difference of an entry, NaN where there is one. Of lists of one length.
inline double largest_change(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = maximum(largest, std::abs(a[i] - b[i]));
  return largest;
}

// The same of matrices of one shape.
template <class A, class B>
requires requires(const A& a) { a.cols(); }
auto largest_change(const A& a, const B& b) {
  using std::abs;
  using T = typename A::Scalar;
  T largest(0);
  for (int j = 0; j < a.cols(); ++j) {
    for (int i = 0; i < a.rows(); ++i) largest = maximum<T>(largest, abs(a(i, j) - b(i, j)));
  }
  return largest;
}

// max-norm of the difference over max(1, size).
template <class V>
auto relative_distance(const V& a, const V& b) {
  using T = typename V::Scalar;
  return largest_change(a, b) / maximum<T>(T(1), largest_entry(b));
}

// a', as a matrix of its own.
template <class T, int rows, int cols>
Matrix<T, cols, rows> transposed(const Matrix<T, rows, cols>& a) {
  Matrix<T, cols, rows> b;
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) b(j, i) = a(i, j);
  }
  return b;
}

// The root of the sum of squares of all entries, and that of the difference.
template <class T, int rows, int cols>
T norm(const Matrix<T, rows, cols>& a) {
  using std::sqrt;
  T sum(0);
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) sum += a(i, j) * a(i, j);
  }
  return sqrt(sum);
}
template <class T, int rows, int cols>
T distance(Matrix<T, rows, cols> a, const Matrix<T, rows, cols>& b) {
  subtract_from(a, b);
  return norm(a);
}

}  // namespace carnot::test
