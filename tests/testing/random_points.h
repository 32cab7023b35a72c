// Random vectors from a seeded local generator: the same numbers in every run.
#pragma once

#include <random>

#include "carnot/numerics/linear_algebra.h"

namespace carnot::test {

using Generator = std::mt19937;

// Uniform in [-scale, scale]^n.
template <int n>
Vector<double, n> random_vector(Generator& generator, double scale = 1) {
  std::uniform_real_distribution<double> uniform(-scale, scale);
  Vector<double, n> v;
  for (int i = 0; i < n; ++i) v[i] = uniform(generator);
  return v;
}

template <int rows, int cols>
Matrix<double, rows, cols> random_matrix(Generator& generator, double scale = 1) {
  Matrix<double, rows, cols> m;
  for (int j = 0; j < cols; ++j) {
    const Vector<double, rows> column = random_vector<rows>(generator, scale);
    for (int i = 0; i < rows; ++i) m(i, j) = column[i];
  }
  return m;
}

// A A' + I/2: eigenvalues in [1/2, n^2 + 1/2].
template <int n>
Matrix<double, n, n> random_positive_matrix(Generator& generator) {
  const Matrix<double, n, n> a = random_matrix<n, n>(generator);
  Matrix<double, n, n> square = times_transposed(a, a);
  for (int i = 0; i < n; ++i) square(i, i) += 0.5;
  return square;
}

}  // namespace carnot::test
