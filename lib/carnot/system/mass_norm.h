// How far a velocity is from another in any units: by sum_j m_j v_j^2.
//
// m_j is the mass of coordinate j alone, the second derivative of L by v_j. Other units of a
// coordinate change m_j against v_j^2, and other units of L change the sum by a factor. A
// coordinate without a mass, or with an infinite one, counts by 1, in the units of the scene.
#pragma once

#include <cmath>
#include <limits>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// What a coordinate counts by whose mass is `own`.
template <class T>
[[nodiscard]] T counted_mass(const T& own) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return own > constant<T>(0) && own < constant<T>(kInfinity) ? own : constant<T>(1);
}

// |v|.
template <class T, int n>
[[nodiscard]] T mass_norm(const Vector<T, n>& masses, const Vector<T, n>& v) {
  using std::sqrt;
  T sum = constant<T>(0);
  for (int j = 0; j < v.size(); ++j) sum += masses[j] * v[j] * v[j];
  return sqrt(sum);
}

// How far a projection moved `from`, relative to its size; zero where it did not.
template <class T, int n>
[[nodiscard]] T relative_move(const Vector<T, n>& masses,
                              const Vector<T, n>& from,
                              const Vector<T, n>& to) {
  const T move = mass_norm(masses, Vector<T, n>(to - from));
  return move == constant<T>(0) ? move : T(move / mass_norm(masses, from));
}

// G W, W the inverse of the diagonal matrix of `masses`.
template <class T, int k, int n>
[[nodiscard]] Matrix<T, k, n> weighed(const Vector<T, n>& masses, Matrix<T, k, n> rows) {
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < k; ++i) rows(i, j) /= masses[j];
  }
  return rows;
}

}  // namespace carnot
