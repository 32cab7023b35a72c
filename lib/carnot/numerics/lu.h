// Dense linear systems of a size known at run time, in place and without allocation.
//
// Gaussian elimination with partial pivoting, row-major. For the fallbacks of gauss.h and
// tangent.h: one instantiation per scalar serves every number of stages, where a fixed-size
// decomposition each would cost minutes of compilation. Real scalars only, never Jets.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace carnot {

// Solves a x = b for `columns` right-hand sides: a is size x size, b is size x columns, row-major;
// both are overwritten, b by the solution. Returns false when a pivot is zero or not a number.
template <class T>
[[nodiscard]] bool lu_solve(int size, T* a, int columns, T* b) {
  using std::abs;
  for (int j = 0; j < size; ++j) {
    int pivot = j;
    for (int i = j + 1; i < size; ++i) {
      if (abs(a[i * size + j]) > abs(a[pivot * size + j])) pivot = i;
    }
    if (!(abs(a[pivot * size + j]) > T(0))) return false;
    if (pivot != j) {
      std::swap_ranges(a + j * size, a + (j + 1) * size, a + pivot * size);
      std::swap_ranges(b + j * columns, b + (j + 1) * columns, b + pivot * columns);
    }
    for (int i = j + 1; i < size; ++i) {
      const T factor = a[i * size + j] / a[j * size + j];
      for (int c = j + 1; c < size; ++c) a[i * size + c] -= factor * a[j * size + c];
      for (int c = 0; c < columns; ++c) b[i * columns + c] -= factor * b[j * columns + c];
    }
  }
  for (int i = size - 1; i >= 0; --i) {
    for (int j = i + 1; j < size; ++j) {
      for (int c = 0; c < columns; ++c) b[i * columns + c] -= a[i * size + j] * b[j * columns + c];
    }
    for (int c = 0; c < columns; ++c) b[i * columns + c] /= a[i * size + i];
  }
  return true;
}

}  // namespace carnot
