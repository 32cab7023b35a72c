// Coefficients of the Radau IIA methods, s stages, order 2s - 1: collocation with the end of the
// step as a node.
//
// The nodes c_i = (1 + x_i)/2 have for x_i the roots of P_s - P_{s-1}, of which the last is 1, and
// b_i = c_i / (s P_{s-1}(x_i))^2. The quadrature has degree 2s - 2, so mu comes from the sum of
// collocation.h. In the last row mu_sj = 1: the last stage is the end of the step.
//
// The methods are stiffly accurate and damp (L-stable), so they are neither symplectic nor
// symmetric: here they show what that costs. Source: Hairer & Wanner, Solving ODEs II, IV.5.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "carnot/tableau/collocation.h"

namespace carnot {

// A root of P_s - P_{s-1} inside (-1, 1) from the guess x.
template <class T>
T radau_root(int s, const T& guess) {
  return newton_root(guess, [s](const T& x) {
    const LegendreValues<T> p = legendre(s, x);
    T derivative = T(s) * (x * p[s] - p[s - 1]);
    if (s > 1) derivative -= T(s - 1) * (x * p[s - 1] - p[s - 2]);
    return T((p[s] - p[s - 1]) * (x * x - T(1)) / derivative);
  });
}

// Radau IIA of s stages, 1 <= s <= kMostCoupledStages. One stage is the implicit Euler rule.
template <class T>
Tableau<T> radau_tableau(int s) {
  assert(s >= 1 && s <= kMostCoupledStages);
  using Wide = Wider<T>;
  Tableau<Wide> wide;
  wide.order = 2 * s - 1;
  wide.c.resize(s);
  wide.b.resize(s);
  std::array<LegendreValues<Wide>, kMostCoupledStages> p;
  for (int i = 0; i < s; ++i) {
    Wide x(1);
    if (i < s - 1) {  // from the asymptotic formula of the Jacobi polynomials P^(1,0)
      x = radau_root(s, Wide(-std::cos(std::numbers::pi * (i + 0.75) / s)));
    }
    p[i] = legendre(s, x);
    wide.c[i] = (Wide(1) + x) / Wide(2);
    wide.b[i] = wide.c[i] / (Wide(s * s) * p[i][s - 1] * p[i][s - 1]);
  }
  set_weights(wide);
  set_extrapolation(wide);
  Tableau<T> tableau = rounded_but_mu<T>(wide);
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      tableau.mu(i, j) = i == s - 1 ? T(1) : T(collocation_mu(p[i], p[j], s - 1));
    }
  }
  return tableau;
}

}  // namespace carnot
