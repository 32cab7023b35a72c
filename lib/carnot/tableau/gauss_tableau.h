// Coefficients of the Gauss collocation methods, s stages, order 2s.
//
// x_i are the roots of the Legendre polynomial P_s, b_i = 1 / ((1 - x_i^2) P_s'(x_i)^2), and mu is
// the sum of collocation.h. The method is symplectic iff b_i a_ij + b_j a_ji = b_i b_j, that is
// mu_ij + mu_ji = 1, and symmetric iff mu_ij + mu_i'j' = 1 with i' = s + 1 - i, j' = s + 1 - j.
// Both hold exactly in floating point: of a pair that sums to one, the larger number is rounded and
// 1 minus it is exact (Sterbenz). After Antonana, Makazaga & Murua, Numer. Algorithms 76 (2017).
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "carnot/tableau/collocation.h"

namespace carnot {

// A root of P_s from the guess x.
template <class T>
T legendre_root(int s, const T& guess) {
  return newton_root(guess, [s](const T& x) {
    const LegendreValues<T> p = legendre(s, x);
    const T derivative = T(s) * (x * p[s] - p[s - 1]) / (x * x - T(1));
    return T(p[s] / derivative);
  });
}

// Gauss of s stages, 1 <= s <= kMostCoupledStages.
template <class T>
Tableau<T> gauss_tableau(int s) {
  assert(s >= 1 && s <= kMostCoupledStages);
  using Wide = Wider<T>;
  Tableau<Wide> wide;
  wide.order = 2 * s;
  wide.c.resize(s);
  wide.b.resize(s);
  std::array<LegendreValues<Wide>, kMostCoupledStages> p;
  for (int i = 0; i < s; ++i) {
    const int mirror = s - 1 - i;
    Wide x(0);  // the middle one of an odd number
    if (i != mirror) {
      const int k = i < mirror ? i : mirror;  // roots ascend and are exactly antisymmetric
      x = legendre_root(s, Wide(-std::cos(std::numbers::pi * (k + 0.75) / (s + 0.5))));
      if (i != k) x = -x;
    }
    p[i] = legendre(s, x);
    p[i][s] = Wide(0);
    const Wide derivative = Wide(s) * p[i][s - 1];  // of P_s, times 1 - x^2, since P_s(x) = 0
    wide.c[i] = (Wide(1) + x) / Wide(2);
    wide.b[i] = (Wide(1) - x) * (Wide(1) + x) / (derivative * derivative);
  }
  set_weights(wide);
  set_extrapolation(wide);
  Tableau<T> tableau = rounded_but_mu<T>(wide);
  for (int i = 0; i < s; ++i) {
    tableau.mu(i, i) = T(1) / T(2);
    for (int j = 0; j < i && i + j < s; ++j) {
      const T mu = rounded_with_complement<T>(collocation_mu(p[i], p[j], s - 1));
      tableau.mu(i, j) = tableau.mu(s - 1 - j, s - 1 - i) = mu;
      tableau.mu(j, i) = tableau.mu(s - 1 - i, s - 1 - j) = T(1) - mu;
    }
  }
  return tableau;
}

}  // namespace carnot
