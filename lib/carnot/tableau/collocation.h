// What collocation methods have in common: Legendre polynomials, their sum for mu, rounding.
//
// Collocation on nodes c_i = (1 + x_i)/2 has a_ij = integral_0^{c_i} l_j. Where the quadrature of
// the nodes integrates polynomials of degree 2s - 2, the Legendre polynomials are orthogonal under
// it, and expanding the Lagrange polynomial l_j in them gives the well-conditioned sum (Hairer &
// Wanner, Solving ODEs II, IV.5, the W-transformation)
//
//   mu_ij = a_ij / b_j = c_i + sum_{m=1}^{s-1} P_m(x_j) (P_{m+1}(x_i) - P_{m-1}(x_i)) / 2.
//
// All is computed in a wider type, then rounded once.
#pragma once

#include <algorithm>
#include <array>

#include "carnot/numerics/coefficients.h"
#include "carnot/tableau/tableau.h"

namespace carnot {

// P_0(x), P_1(x), ...
template <class T>
using LegendreValues = std::array<T, kMostCoupledStages + 1>;

// P_0(x), ..., P_degree(x), degree > 0, by the three-term recurrence; the others are zero.
template <class T>
LegendreValues<T> legendre(int degree, const T& x) {
  LegendreValues<T> p;
  p.fill(T(0));
  p[0] = T(1);
  p[1] = x;
  for (int m = 1; m < degree; ++m) {
    p[m + 1] = (T(2 * m + 1) * x * p[m] - T(m) * p[m - 1]) / T(m + 1);
  }
  return p;
}

// mu_ij of collocation from the Legendre polynomials at x_i, up to degree `terms` + 1, and at x_j.
template <class T>
T collocation_mu(const LegendreValues<T>& at_i, const LegendreValues<T>& at_j, int terms) {
  const T half = T(1) / T(2);
  T mu = half * (T(1) + at_i[1]);
  for (int m = 1; m <= terms; ++m) mu += half * at_j[m] * (at_i[m + 1] - at_i[m - 1]);
  return mu;
}

// x such that x and 1 - x are both exact in T.
template <class T, class Wide>
T rounded_with_complement(const Wide& x) {
  return x >= Wide(1) / Wide(2) ? T(x) : T(1) - T(Wide(1) - x);
}

// The weights of Legendre coefficients and of the continuation by the first of them, from nodes and
// weights.
template <class T>
void set_legendre(Tableau<T>& tableau) {
  constexpr int kKept = 4;
  const int s = tableau.stages();
  tableau.legendre.resize(s, s);
  tableau.cautious.setZero(s, s);
  for (int j = 0; j < s; ++j) {
    const LegendreValues<T> at = legendre(s, T(T(2) * tableau.c[j] - T(1)));
    for (int k = 0; k < s; ++k) tableau.legendre(k, j) = T(2 * k + 1) * at[k];
  }
  for (int i = 0; i < s; ++i) {
    const LegendreValues<T> beyond = legendre(s, T(T(2) * tableau.c[i] + T(1)));
    for (int k = 0; k < std::min(kKept, s); ++k) {
      const T weight = tableau.omega[i] * beyond[k];
      for (int j = 0; j < s; ++j) tableau.cautious(i, j) += weight * tableau.legendre(k, j);
    }
  }
}

// The tableau rounded to T: order, nodes, weights and extrapolation. Of mu only the size is set.
template <class T, class Wide>
Tableau<T> rounded_but_mu(const Tableau<Wide>& wide) {
  Tableau<T> tableau;
  tableau.order = wide.order;
  tableau.coupling = wide.coupling;
  tableau.partitioned = wide.partitioned;
  tableau.c = wide.c.template cast<T>();
  tableau.b = wide.b.template cast<T>();
  tableau.mu.resize(wide.stages(), wide.stages());
  tableau.extrapolation = wide.extrapolation.template cast<T>();
  set_weights(tableau);
  set_legendre(tableau);
  return tableau;
}

// A root of a function f from the guess x, by Newton's method; `correction` is f/f'. The guesses of
// nodes are good to 1e-2, from where six iterations reach 64 digits.
template <class T, class F>
T newton_root(T x, const F& correction) {
  constexpr int kIterations = 8;
  for (int iteration = 0; iteration < kIterations; ++iteration) x -= correction(x);
  return x;
}

}  // namespace carnot
