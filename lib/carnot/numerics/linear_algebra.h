// Fixed-size vectors and matrices over any scalar: double, long double, a quad type, a Pack, a Jet.
//
// EIGEN_MAX_ALIGN_BYTES is 16 for everyone who includes this, as the target carnot::core sees to,
// so that files compiled for different instruction sets agree on the layout of vectors.
#pragma once

#include <Eigen/Core>
#include <algorithm>
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

// What follows, and the steps of methods (step/), are loops over entries. Eigen's expressions of
// the same take the compiler several times as long: each of their types declares all that a matrix
// can do, once more for every size and scalar.

// a b.
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

// a', as product() reads it.
template <class A>
struct Transposed {
  using Scalar = typename A::Scalar;
  // NOLINTBEGIN(readability-identifier-naming): the names are those of Eigen
  static constexpr int RowsAtCompileTime = A::ColsAtCompileTime;
  static constexpr int ColsAtCompileTime = A::RowsAtCompileTime;
  // NOLINTEND(readability-identifier-naming)
  const A& a;
  decltype(auto) operator()(int i, int j) const { return a(j, i); }
};

// a' b, and a b'.
template <class A, class B>
auto transposed_times(const A& a, const B& b) {
  return product(Transposed<A>{a}, b);
}
template <class A, class B>
auto times_transposed(const A& a, const B& b) {
  return product(a, Transposed<B>{b});
}

// a += b and a -= b.
template <class T, int rows, int cols>
void add_to(Matrix<T, rows, cols>& a, const Matrix<T, rows, cols>& b) {
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) a(i, j) += b(i, j);
  }
}
template <class T, int rows, int cols>
void subtract_from(Matrix<T, rows, cols>& a, const Matrix<T, rows, cols>& b) {
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) a(i, j) -= b(i, j);
  }
}

// A vector of one number, and a matrix of one.
template <int n, class T>
Vector<T, n> filled(const T& entry) {
  Vector<T, n> x;
  for (int i = 0; i < n; ++i) x[i] = entry;
  return x;
}
template <int rows, int cols, class T>
Matrix<T, rows, cols> filled(const T& entry) {
  Matrix<T, rows, cols> a;
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) a(i, j) = entry;
  }
  return a;
}

template <int n, class T>
Matrix<T, n, n> identity() {
  Matrix<T, n, n> one;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) one(i, j) = T(i == j ? 1 : 0);
  }
  return one;
}

// `count` entries of x from `first` on.
template <int first, int count, class T, int n>
Vector<T, count> part(const Vector<T, n>& x) {
  static_assert(first >= 0 && first + count <= n);
  Vector<T, count> some;
  for (int i = 0; i < count; ++i) some[i] = x[first + i];
  return some;
}

template <class T, int n>
T dot(const Vector<T, n>& a, const Vector<T, n>& b) {
  T sum = a[0] * b[0];
  for (int i = 1; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

// The absolute value of every entry.
template <class T, int rows, int cols>
Matrix<T, rows, cols> absolute(const Matrix<T, rows, cols>& a) {
  using std::abs;
  Matrix<T, rows, cols> sizes;
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) sizes(i, j) = abs(a(i, j));
  }
  return sizes;
}

// The largest absolute value of an entry; 0 where there is none. Not a number where an entry is
// not.
template <class A>
auto largest_entry(const A& a) {
  using std::abs;
  using T = typename A::Scalar;
  T largest(0);
  for (int j = 0; j < a.cols(); ++j) {
    for (int i = 0; i < a.rows(); ++i) largest = maximum<T>(largest, abs(a(i, j)));
  }
  return largest;
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

// Vectors and matrices from plain numbers and to them, in the order in which Eigen keeps them.
template <int n>
Vector<double, n> vector_at(const double* x) {
  Vector<double, n> copy;
  for (int i = 0; i < n; ++i) copy[i] = x[i];
  return copy;
}
template <int rows, int cols>
void store(const Matrix<double, rows, cols>& a, double* to) {
  std::copy_n(a.data(), rows * cols, to);
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
