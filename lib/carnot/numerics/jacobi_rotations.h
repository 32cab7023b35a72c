// Orthogonal columns by one-sided Jacobi rotations.
//
// Rotations V of the columns, pair by pair, make those of A orthogonal, A V = W; their norms are
// the singular values of A (Hestenes 1958). This always converges, and small singular values come
// with small relative errors where A is small only by the scale of its columns (Demmel & Veselic
// 1992). Real scalars only, never Jets.
#pragma once

#include <cmath>
#include <utility>

#include "carnot/numerics/scalar.h"

namespace carnot {

// Rotates the columns of A, `rows` x `cols`, and those of V, `cols` x `cols`, likewise, until those
// of A are orthogonal: to 2 rows eps, what round-off of the products alone can leave. Both are
// stored column by column. False where the sweeps were not enough; a NaN is left where it is. A
// sweep takes about 6 rows flops for each pair of columns, and 6 cols for those of V.
template <class T>
[[nodiscard]] bool orthogonalise_columns(int rows, int cols, T* a, T* v) {
  static_assert(!kIsJet<T>, "differentiate the equation instead");
  using std::abs, std::hypot, std::sqrt;
  constexpr int kMaxSweeps = 60;  // quadratic convergence: matrices of the tests need up to ten
  const T zero = T(2 * rows) * epsilon<T>();
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    bool rotated = false;
    for (int i = 0; i + 1 < cols; ++i) {
      for (int j = i + 1; j < cols; ++j) {
        T ii(0);
        T jj(0);
        T ij(0);
        for (int r = 0; r < rows; ++r) {
          ii += a[i * rows + r] * a[i * rows + r];
          jj += a[j * rows + r] * a[j * rows + r];
          ij += a[i * rows + r] * a[j * rows + r];
        }
        if (!(abs(ij) > zero * sqrt(ii) * sqrt(jj))) continue;
        rotated = true;
        // tan of the angle that makes the pair orthogonal: t^2 + 2 cot t = 1, the smaller root.
        const T cot = (jj - ii) / (T(2) * ij);
        const T tan = (cot < T(0) ? T(-1) : T(1)) / (abs(cot) + hypot(T(1), cot));
        const T cosine = T(1) / sqrt(T(1) + tan * tan);
        const T sine = cosine * tan;
        for (const auto& [m, length] : {std::pair{a, rows}, std::pair{v, cols}}) {
          for (int r = 0; r < length; ++r) {
            const T left = m[i * length + r];
            const T right = m[j * length + r];
            m[i * length + r] = cosine * left - sine * right;
            m[j * length + r] = sine * left + cosine * right;
          }
        }
      }
    }
    if (!rotated) return true;
  }
  return false;
}

}  // namespace carnot
