// Units in which the rows and columns of a square matrix are of like size.
//
// An entry A_ij that takes a number in units d_j to one in units d_i becomes A_ij d_j / d_i. In
// turn each d_i is chosen such that the sums of row i and of column i, without the diagonal, become
// equal, until none changes (Osborne, J. ACM 7, 1960; Parlett & Reinsch, Numer. Math. 13, 1969).
// Where one of the sums is zero, the other comes to lie between 1/2 and 1. All are powers of two,
// so that nothing is rounded.
#pragma once

#include <cmath>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

// d of a matrix, of which `sizes` has the absolute values. They are finite. Cost: some n^2.
template <class T, int n>
[[nodiscard]] Vector<T, n> balanced_units(Matrix<T, n, n> sizes) {
  using std::frexp, std::ldexp;
  constexpr int kMostSweeps = 16;
  Vector<T, n> units;
  for (int i = 0; i < n; ++i) units[i] = T(1);
  bool changing = true;
  for (int sweep = 0; changing && sweep < kMostSweeps; ++sweep) {
    changing = false;
    for (int i = 0; i < n; ++i) {
      T row(0);
      T column(0);
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        row += sizes(i, j);
        column += sizes(j, i);
      }
      int exponent = 0;
      if (row > T(0) && column > T(0)) {
        (void)frexp(row / column, &exponent);
        exponent /= 2;
      } else if (row > T(0)) {
        (void)frexp(row, &exponent);
      } else if (column > T(0)) {
        (void)frexp(column, &exponent);
        exponent = -exponent;
      }
      if (exponent == 0) continue;
      changing = true;
      units[i] = ldexp(units[i], exponent);
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        sizes(i, j) = ldexp(sizes(i, j), -exponent);
        sizes(j, i) = ldexp(sizes(j, i), exponent);
      }
    }
  }
  return units;
}

}  // namespace carnot
