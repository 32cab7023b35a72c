// The stages of a step side by side in packs: row k of a 2n x s array holds component k of all.
#pragma once

#include <array>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/pack.h"
#include "carnot/system/index_one_system.h"

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

// What one iteration did.
struct Sweep {
  bool ok = false;    // else some lane fails: ask rate() one by one which and why
  double change = 0;  // the largest of an entry of the stages
};

// One iteration on all stages: U from the increments L, row k <- value_k + (compensation_k + mu
// L_k), then L = weights f(U), and y. The largest change of each row comes in `change`, unless it
// is null.
template <class System, int s>
[[gnu::flatten, gnu::noinline]] Sweep packed_sweep(const System& system,
                                                   const double* time,
                                                   const double* mu,
                                                   const double* weights,
                                                   const double* value,
                                                   const double* compensation,
                                                   double* stages,
                                                   double* algebraic,
                                                   double* increments,
                                                   double* change) {
  constexpr int n = System::kDof;
  using P = Pack<s>;
  Vector<P, n> q;
  Vector<P, n> p;
  P most(0);
  for (int k = 0; k < 2 * n; ++k) {
    const P u = P(value[k]) + combination<s>(mu, increments + k * s, P(compensation[k]));
    const P moved = abs(u - P::load(stages + k * s));
    u.store(stages + k * s);
    if (change != nullptr) change[k] = largest(moved);
    most = max(most, moved);
    (k < n ? q[k] : p[k - n]) = u;
  }
  Vector<P, System::kAlgebraic> y;
  Rate<P, n> rate;
  Sweep sweep{false, largest(most)};
  if (system.rate(P::load(time), q, p, y, rate) != RateStatus::kOk) return sweep;
  const P weight = P::load(weights);
  for (int k = 0; k < n; ++k) {
    (weight * rate.q_dot[k]).store(increments + k * s);
    (weight * rate.p_dot[k]).store(increments + (n + k) * s);
  }
  for (int k = 0; k < System::kAlgebraic; ++k) y[k].store(algebraic + k * s);
  sweep.ok = true;
  return sweep;
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

// One iteration on the tangents dL = A (dz + mu dL) of all stages: entry (r, c) of A is row
// size r + c of `jacobian`, column c of dz is `dz + size c`, entry r of its dL row size c + r of
// `increments`. Returns the largest change.
template <int size, int s>
[[gnu::flatten, gnu::noinline]] double packed_tangent_sweep(const double* mu,
                                                            const double* jacobian,
                                                            const double* dz,
                                                            const double* compensation,
                                                            double* increments) {
  using P = Pack<s>;
  P most(0);
  for (int c = 0; c < size; ++c) {
    double* const column = increments + c * size * s;
    std::array<P, size> argument;
    for (int k = 0; k < size; ++k) {
      argument[k] =
          P(dz[c * size + k]) + combination<s>(mu, column + k * s, P(compensation[c * size + k]));
    }
    for (int r = 0; r < size; ++r) {
      const double* const row = jacobian + r * size * s;
      P even = P::load(row) * argument[0];
      P odd = P::load(row + s) * argument[1];
      for (int k = 2; k < size; k += 2) {
        even += P::load(row + k * s) * argument[k];
        odd += P::load(row + (k + 1) * s) * argument[k + 1];
      }
      const P sum = even + odd;
      most = max(most, abs(sum - P::load(column + r * s)));
      sum.store(column + r * s);
    }
  }
  return largest(most);
}

}  // namespace carnot
