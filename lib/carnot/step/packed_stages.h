// The stages of a step side by side in packs: row k of a 2n x s array holds component k of all.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/pack.h"
#include "carnot/system/packed_iteration.h"

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

// What an iteration on the stages of a step of h from t begins with: their times t + c_i h, the
// weights h omega_i of their rates, and stages from which any other is far. Stored in whole
// registers, as the first sweep loads them: of numbers that come one by one it has to wait for all.
// Flows of the vehicle take 0.96 of the time (Zen 5).
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] void packed_beginning(double t,
                                                       double h,
                                                       const double* c,
                                                       const double* omega,
                                                       double* times,
                                                       double* weights,
                                                       double* stages) {
  using P = Pack<s>;
  (P(t) + P(h) * P::load(c)).store(times);
  (P(h) * P::load(omega)).store(weights);
  const P far(std::numeric_limits<double>::max());
  for (int k = 0; k < size; ++k) far.store(stages + k * s);
}

// Row k of `increments` <- A row k: the first guess from the last step.
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] void packed_extrapolation(const double* matrix,
                                                           double* increments) {
  const auto columns = columns_of<s>(matrix);
  for (int k = 0; k < size; ++k) {
    combination<s>(columns, increments + k * s, Pack<s>(0)).store(increments + k * s);
  }
}

// The largest entry of each of the s combinations A row k, over the rows k.
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] void packed_sizes(const double* matrix,
                                                   const double* rows,
                                                   double* largest) {
  const auto columns = columns_of<s>(matrix);
  Pack<s> most(0);
  for (int k = 0; k < size; ++k) {
    most = max(most, abs(combination<s>(columns, rows + k * s, Pack<s>(0))));
  }
  most.store(largest);
}

// The sum of each row.
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] void packed_sums(const double* rows, double* sums) {
  for (int k = 0; k < size; ++k) sums[k] = sum(Pack<s>::load(rows + k * s));
}

// The largest sum of the absolute values in a row.
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] double packed_distance(const double* rows) {
  double most = 0;
  for (int k = 0; k < size; ++k) most = std::max(most, sum(abs(Pack<s>::load(rows + k * s))));
  return most;
}

// One iteration on the tangents dL = A (dz + mu dL) of all stages: entry (r, c) of A is row
// size r + c of `jacobian`, column c of dz is `dz + size c`, entry r of its dL row size c + r of
// `increments`. Returns the largest change, that of column c times weights[c].
template <int size, int s>
CARNOT_FLATTEN [[gnu::noinline]] double packed_tangent_sweep(const double* mu,
                                                             const double* jacobian,
                                                             const double* dz,
                                                             const double* compensation,
                                                             const double* weights,
                                                             double* increments) {
  using P = Pack<s>;
  const auto columns = columns_of<s>(mu);
  P largest_of_all(0);
  for (int c = 0; c < size; ++c) {
    P most(0);
    double* const column = increments + c * size * s;
    std::array<P, size> argument;
#pragma GCC unroll 16
    for (int k = 0; k < size; ++k) {
      argument[k] = P(dz[c * size + k]) +
                    combination<s>(columns, column + k * s, P(compensation[c * size + k]));
    }
    for (int r = 0; r < size; ++r) {
      const double* const row = jacobian + r * size * s;
      P even = P::load(row) * argument[0];
      P odd = P::load(row + s) * argument[1];
#pragma GCC unroll 8
      for (int k = 2; k < size; k += 2) {
        even += P::load(row + k * s) * argument[k];
        odd += P::load(row + (k + 1) * s) * argument[k + 1];
      }
      const P sum = even + odd;
      most = max(most, abs(sum - P::load(column + r * s)));
      sum.store(column + r * s);
    }
    largest_of_all = max(largest_of_all, P(weights[c]) * most);
  }
  return largest(largest_of_all);
}

}  // namespace carnot
