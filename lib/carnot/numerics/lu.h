// Dense linear systems of a size known at run time, in place and without allocation.
//
// Gaussian elimination with partial pivoting, row-major. For the fallbacks of gauss.h and
// tangent.h: one instantiation per scalar serves every number of stages, where a fixed-size
// decomposition each would cost minutes of compilation. Real scalars only, never Jets.
//
// Eight columns are eliminated before what is right of them is brought up to date, so that a row
// there is read and written once for eight rows that are subtracted from it, in loops of a length
// that compilers know. For eight stages of a vehicle, 64 unknowns, that takes 0.35 to 0.4 of the
// time of one column after the other; to the last bit it is the same.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace carnot {
namespace lu {

inline constexpr int kPiece = 8;  // columns

// to -= sum_l factors[l] from_l, for `count` numbers; row l begins l * stride after row 0.
template <class T>
void subtract_rows(
    const T* factors, int rows, const T* from, int stride, T* __restrict to, int count) {
  int c = 0;
  for (; c + kPiece <= count; c += kPiece) {
    std::array<T, kPiece> sum;
    for (int e = 0; e < kPiece; ++e) sum[e] = to[c + e];
    for (int l = 0; l < rows; ++l) {
      const T factor = factors[l];
      const T* const row = from + l * stride + c;
      for (int e = 0; e < kPiece; ++e) sum[e] -= factor * row[e];
    }
    for (int e = 0; e < kPiece; ++e) to[c + e] = sum[e];
  }
  for (; c < count; ++c) {
    T sum = to[c];
    for (int l = 0; l < rows; ++l) sum -= factors[l] * from[l * stride + c];
    to[c] = sum;
  }
}

// Eliminates column j from the rows below row j, as far as column end - 1. Column j holds the
// factors then.
template <class T>
void eliminate(int size, T* a, int j, int begin, int end) {
  const T* const row = a + j * size;
  if (end - begin < kPiece) {
    for (int i = j + 1; i < size; ++i) {
      T* const to = a + i * size;
      to[j] /= row[j];
      for (int c = j + 1; c < end; ++c) to[c] -= to[j] * row[c];
    }
    return;
  }
  std::array<T, kPiece> right{};  // zero up to column j, whose factors are to stay
  for (int c = j + 1; c < end; ++c) right[c - begin] = row[c];
  for (int i = j + 1; i < size; ++i) {
    T* const to = a + i * size;
    const T factor = to[j] / row[j];
    for (int e = 0; e < kPiece; ++e) to[begin + e] -= factor * right[e];
    to[j] = factor;
  }
}

}  // namespace lu

// Solves a x = b for `columns` right-hand sides: a is size x size, b is size x columns, row-major;
// both are overwritten, b by the solution. Returns false when a pivot is zero or not a number.
template <class T>
[[nodiscard]] bool lu_solve(int size, T* a, int columns, T* b) {
  using std::abs;
  for (int begin = 0; begin < size; begin += lu::kPiece) {
    const int end = std::min(begin + lu::kPiece, size);
    for (int j = begin; j < end; ++j) {
      int pivot = j;
      for (int i = j + 1; i < size; ++i) {
        if (abs(a[i * size + j]) > abs(a[pivot * size + j])) pivot = i;
      }
      if (!(abs(a[pivot * size + j]) > T(0))) return false;
      if (pivot != j) {
        std::swap_ranges(a + j * size + begin, a + (j + 1) * size, a + pivot * size + begin);
        std::swap_ranges(b + j * columns, b + (j + 1) * columns, b + pivot * columns);
      }
      lu::eliminate(size, a, j, begin, end);
    }
    for (int i = begin + 1; i < size; ++i) {
      const T* const factors = a + i * size + begin;
      const int rows = std::min(i, end) - begin;
      const T* const from = a + begin * size + end;
      if (end < size) {
        lu::subtract_rows(factors, rows, from, size, a + i * size + end, size - end);
      }
      lu::subtract_rows(factors, rows, b + begin * columns, columns, b + i * columns, columns);
    }
  }
  for (int i = size - 1; i >= 0; --i) {
    const T* const right = a + i * size + i + 1;
    const T* const below = b + (i + 1) * columns;
    lu::subtract_rows(right, size - i - 1, below, columns, b + i * columns, columns);
    for (int c = 0; c < columns; ++c) b[i * columns + c] /= a[i * size + i];
  }
  return true;
}

// Compiled once, so that all programs have the same bits.
extern template bool lu_solve<double>(int size, double* a, int columns, double* b);

}  // namespace carnot
