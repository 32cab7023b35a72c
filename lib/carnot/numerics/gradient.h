// Exact derivatives of a templated function by dual numbers.
//
// With q + e, e_i e_j = 0, a function evaluates to f(q) + sum_i f_i(q) e_i (see ceres/jet.h).
// f is evaluated once; the cost is that of f on Jets with n partial derivatives.
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// q with one dual direction per component.
template <class T, int n>
Vector<Jet<T, n>, n> seeded(const Vector<T, n>& q) {
  Vector<Jet<T, n>, n> x;
  for (int i = 0; i < n; ++i) {
    x[i].a = q[i];
    for (int j = 0; j < n; ++j) x[i].v[j] = constant<T>(i == j ? 1.0 : 0.0);
  }
  return x;
}

// A vector of constants for a function that is differentiated in its other arguments.
template <class J, class T, int n>
Vector<J, n> unseeded(const Vector<T, n>& v) {
  Vector<J, n> x;
  for (int i = 0; i < n; ++i) x[i] = J(v[i]);
  return x;
}

// The values of Jets, and the derivatives of a vector of them, one row for each.
template <class T, int N, int rows, int cols>
Matrix<T, rows, cols> primal(const Matrix<Jet<T, N>, rows, cols>& x) {
  Matrix<T, rows, cols> values;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) values(i, j) = x(i, j).a;
  }
  return values;
}
template <class T, int N, int n>
Matrix<T, n, N> tangents(const Vector<Jet<T, N>, n>& x) {
  Matrix<T, n, N> slopes;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < N; ++j) slopes(i, j) = x[i].v[j];
  }
  return slopes;
}

// f: Vector<U, n> -> U for U = Jet<T, n>. Returns the n partial derivatives at q.
template <class F, class T, int n>
Vector<T, n> gradient(const F& f, const Vector<T, n>& q) {
  return f(seeded(q)).v;
}

}  // namespace carnot
