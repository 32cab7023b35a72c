// Fixed-size vectors and matrices over any scalar: double, long double, a quad type, a Pack, a Jet.
//
// EIGEN_MAX_ALIGN_BYTES is 16 for everyone who includes this, as the target carnot::core sees to,
// so that files compiled for different instruction sets agree on the layout of vectors.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "carnot/numerics/scalar.h"

#if EIGEN_MAX_ALIGN_BYTES != 16
#error "carnot needs EIGEN_MAX_ALIGN_BYTES=16: link with carnot::core in CMake, which defines it"
#endif

namespace carnot {

template <class T, int n>
using Vector = Eigen::Matrix<T, n, 1>;

template <class T, int rows, int cols>
using Matrix = Eigen::Matrix<T, rows, cols>;

// A diagonal matrix of these entries: diagonal<T>(1, 1, 0.25, 0.5).
template <class T, class... Entries>
Matrix<T, sizeof...(Entries), sizeof...(Entries)> diagonal(const Entries&... entries) {
  constexpr int n = sizeof...(Entries);
  const T values[] = {T(entries)...};
  Matrix<T, n, n> a;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) a(i, j) = i == j ? values[i] : T(0);
  }
  return a;
}

// Products as plain sums, without Eigen's expressions, which take the compiler several times as
// long.
template <class A, class B>
auto product(const A& a, const B& b) {
  using T = typename A::Scalar;
  constexpr int kRows = A::RowsAtCompileTime;
  constexpr int kInner = A::ColsAtCompileTime;
  constexpr int kCols = B::ColsAtCompileTime;
  static_assert(kInner == B::RowsAtCompileTime && kInner > 0);
  Matrix<T, kRows, kCols> c;
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j < kCols; ++j) {
      T sum = a(i, 0) * b(0, j);
      for (int k = 1; k < kInner; ++k) sum += a(i, k) * b(k, j);
      c(i, j) = sum;
    }
  }
  return c;
}

template <class T, int n>
T dot(const Vector<T, n>& a, const Vector<T, n>& b) {
  T sum = a[0] * b[0];
  for (int i = 1; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

// No entry is infinite or not a number: zero times it is zero.
template <class Derived>
bool all_finite(const Eigen::MatrixBase<Derived>& a) {
  using Number = std::decay_t<decltype(value_of(a(0, 0)))>;
  Number zero(0);
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.cols(); ++j) zero += Number(0) * value_of(a(i, j));
  }
  return all(zero <= Number(0));
}

// A vector on somebody else's numbers.
template <int n>
Eigen::Map<const Vector<double, n>> view(const double* x) {
  return Eigen::Map<const Vector<double, n>>(x, n);
}
template <int n>
Eigen::Map<Vector<double, n>> view(double* x) {
  return Eigen::Map<Vector<double, n>>(x, n);
}

// The numbers of a vector or matrix, in the order in which it keeps them.
template <class Derived>
std::span<const double> span_of(const Eigen::PlainObjectBase<Derived>& a) {
  return {a.data(), static_cast<std::size_t>(a.size())};
}
template <class Derived>
std::span<double> span_of(Eigen::PlainObjectBase<Derived>& a) {
  return {a.data(), static_cast<std::size_t>(a.size())};
}

}  // namespace carnot
