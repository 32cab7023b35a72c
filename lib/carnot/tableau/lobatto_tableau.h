// Coefficients of the partitioned pair Lobatto IIIA (for q) - IIIB (for p), s stages, order 2s - 2.
//
// The nodes c_i = (1 + x_i)/2 have for x_i the roots of P_s - P_{s-2}: the ends and the extrema of
// P_{s-1}; b_i = 1 / (s (s - 1) P_{s-1}(x_i)^2). IIIA is collocation on them. The quadrature has
// degree 2s - 3 only, so P_{s-1} has another norm under it, but its integral up to a node vanishes:
//
//   mu_ij = a_ij / b_j = c_i + sum_{m=1}^{s-2} P_m(x_j) (P_{m+1}(x_i) - P_{m-1}(x_i)) / 2.
//
// IIIB makes the pair symplectic: b_i a^_ij + b_j a_ji = b_i b_j, that is mu_p_ij = 1 - mu_ji,
// which holds exactly in floating point, as does the symmetry of both (see gauss_tableau.h).
// Entries may lie outside [0, 1]: the larger of x and 1 - x is at least 1/2, and 1 minus it is
// exact, being a multiple of its last place and not larger than it.
//
// Algebraic variables: there is one y_i for each stage, found from H_y = 0 at the pair (Q_i, P_i),
// and both q_dot and p_dot of that stage use it. So the velocity constraints hold at every stage,
// and the step is that of the pair on the system with y eliminated, whose order and symplecticity
// it has. With one y for a whole step, or y of (Q_i, p), neither would follow. In IIIB no stage is
// P_1 = p, so the first and last pairs are not the nodes (q, p) and (q+, p+), although Q_1 = q and
// Q_s = q+; the multipliers at the nodes come from H_y = 0 there.
//
// Two stages are the Stoermer-Verlet rule, also called leapfrog: with P = P_1 = P_2,
//   P = p - h/2 H_q(q, P, y_1),  q+ = q + h/2 (H_p(q, P, y_1) + H_p(q+, P, y_2)),
//   p+ = P - h/2 H_q(q+, P, y_2).
// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, II.2 and VI.4.
#pragma once

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "carnot/tableau/collocation.h"

namespace carnot {

// A root of P_s - P_{s-2} inside (-1, 1) from the guess x.
template <class T>
T lobatto_root(int s, const T& guess) {
  return newton_root(guess, [s](const T& x) {
    const LegendreValues<T> p = legendre(s, x);
    return T((p[s] - p[s - 2]) / (T(2 * s - 1) * p[s - 1]));
  });
}

// Lobatto IIIA-IIIB of s stages, 2 <= s <= kMostCoupledStages.
template <class T>
Tableau<T> lobatto_tableau(int s) {
  assert(s >= 2 && s <= kMostCoupledStages);
  using Wide = Wider<T>;
  Tableau<Wide> wide;
  wide.order = 2 * s - 2;
  wide.partitioned = true;
  wide.c.resize(s);
  wide.b.resize(s);
  std::array<LegendreValues<Wide>, kMostCoupledStages> p;
  for (int i = 0; i < s; ++i) {
    const int mirror = s - 1 - i;
    const int k = i < mirror ? i : mirror;  // roots ascend and are exactly antisymmetric
    Wide x(k == 0 ? -1 : 0);
    if (k > 0 && i != mirror) {  // from the asymptotic formula of the Jacobi polynomials P^(1,1)
      x = lobatto_root(s, Wide(-std::cos(std::numbers::pi * (k + 0.25) / (s - 0.5))));
    }
    if (i != k) x = -x;
    p[i] = legendre(s, x);
    wide.c[i] = (Wide(1) + x) / Wide(2);
    wide.b[i] = Wide(1) / (Wide(s * (s - 1)) * p[i][s - 1] * p[i][s - 1]);
  }
  set_weights(wide);
  set_extrapolation(wide);
  Tableau<T> tableau = rounded_but_mu<T>(wide);
  tableau.mu_p.resize(s, s);
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      const int ri = s - 1 - i;
      const int rj = s - 1 - j;
      if (i > ri || (i == ri && j > rj)) continue;  // set with its mirror image
      const bool centre = i == ri && j == rj;
      const Wide mu = centre ? Wide(1) / Wide(2) : collocation_mu(p[i], p[j], s - 2);
      tableau.mu(i, j) = rounded_with_complement<T>(mu);
      if (!centre) tableau.mu(ri, rj) = T(1) - tableau.mu(i, j);
    }
  }
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) tableau.mu_p(i, j) = T(1) - tableau.mu(j, i);
  }
  return tableau;
}

}  // namespace carnot
