// The stages of a step side by side in packs: row k of a 2n x s array holds component k of all.
#pragma once

#include "carnot/linear_algebra.h"
#include "carnot/pack.h"

namespace carnot {

// Rows of s numbers, in memory row by row where s is fixed; a row then fits one pack.
template <class T, int rows, int s, int most>
using StageRows =
    Eigen::Matrix<T,
                  rows,
                  s,
                  rows == 1 || (s != Eigen::Dynamic && s != 1) ? Eigen::RowMajor : Eigen::ColMajor,
                  rows,
                  most>;

// sum + A x for an s x s matrix with its columns one after the other. Two chains of additions, for
// the processor to overlap.
template <int s>
[[gnu::always_inline]] inline Pack<s> combination(const double* columns,
                                                  const double* x,
                                                  const Pack<s>& sum) {
  Pack<s> even = sum + Pack<s>::load(columns) * Pack<s>(x[0]);
  Pack<s> odd = Pack<s>::load(columns + s) * Pack<s>(x[1]);
  for (int j = 2; j < s; j += 2) {
    even += Pack<s>::load(columns + j * s) * Pack<s>(x[j]);
    odd += Pack<s>::load(columns + (j + 1) * s) * Pack<s>(x[j + 1]);
  }
  return even + odd;
}

// Row k of `increments` <- A row k: the first guess from the last step.
template <int size, int s>
[[gnu::flatten, gnu::noinline]] void packed_extrapolation(const double* columns,
                                                          double* increments) {
  for (int k = 0; k < size; ++k) {
    combination<s>(columns, increments + k * s, Pack<s>(0)).store(increments + k * s);
  }
}

// The stages U from the increments L: row k <- value_k + (compensation_k + mu L_k). Returns the
// largest change of an entry; that of each row comes in `change`, unless it is null.
template <int size, int s>
[[gnu::flatten, gnu::noinline]] double packed_stages(const double* mu,
                                                     const double* value,
                                                     const double* compensation,
                                                     const double* increments,
                                                     double* stages,
                                                     double* change) {
  using P = Pack<s>;
  P most(0);
  for (int k = 0; k < size; ++k) {
    const P u = P(value[k]) + combination<s>(mu, increments + k * s, P(compensation[k]));
    const P moved = abs(u - P::load(stages + k * s));
    u.store(stages + k * s);
    if (change != nullptr) change[k] = largest(moved);
    most = max(most, moved);
  }
  return largest(most);
}

// The largest entry of each of the s combinations A row k, over the rows k.
template <int size, int s>
[[gnu::flatten, gnu::noinline]] void packed_sizes(const double* columns,
                                                  const double* rows,
                                                  double* largest) {
  Pack<s> most(0);
  for (int k = 0; k < size; ++k) {
    most = max(most, abs(combination<s>(columns, rows + k * s, Pack<s>(0))));
  }
  most.store(largest);
}

// Row k of `rates` times the row `weights` (h omega): the increments.
template <int size, int s>
[[gnu::flatten, gnu::noinline]] void packed_increments(double h,
                                                       const double* omega,
                                                       double* rates) {
  using P = Pack<s>;
  const P weights = P(h) * P::load(omega);
  for (int k = 0; k < size; ++k) (weights * P::load(rates + k * s)).store(rates + k * s);
}

}  // namespace carnot
