// Coefficients of the Gauss collocation methods, s stages, order 2s.
//
// Nodes c_i = (1 + x_i)/2 with x_i the roots of the Legendre polynomial P_s, weights
// b_i = 1 / ((1 - x_i^2) P_s'(x_i)^2), and a_ij = integral_0^{c_i} l_j. Expanding the Lagrange
// polynomial l_j in shifted Legendre polynomials (orthogonal under the quadrature itself) gives the
// well-conditioned sum (Hairer & Wanner, Solving ODEs II, IV.5, the W-transformation)
//
//   mu_ij = a_ij / b_j = c_i + sum_{m=1}^{s-1} P_m(x_j) (P_{m+1}(x_i) - P_{m-1}(x_i)) / 2.
//
// The method is symplectic iff b_i a_ij + b_j a_ji = b_i b_j, that is mu_ij + mu_ji = 1. Stored are
// b and mu, and that identity holds exactly in floating point: of a pair that sums to one, the
// number in [1/2, 2] is rounded and 1 minus it is exact (Sterbenz). After Antonana, Makazaga &
// Murua, Numer. Algorithms 76 (2017). All is computed in a wider type, then rounded once.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "carnot/linear_algebra.h"

namespace carnot {

template <class T, int s>
struct GaussTableau {
  Vector<T, s> c;      // nodes
  Vector<T, s> b;      // weights
  Matrix<T, s, s> mu;  // a_ij / b_j; mu_ij + mu_ji = 1 exactly

  // Row i, column j: weight of the stage value f_j of the last step in the value at node i of the
  // next one, by extrapolation of the collocation polynomial; already divided by b_j and times b_i,
  // so that it acts on L_j = h b_j f_j.
  Matrix<T, s, s> extrapolation;
};

// P_0(x), ..., P_degree(x) by the three-term recurrence.
template <class T, int degree>
std::array<T, degree + 1> legendre(const T& x) {
  std::array<T, degree + 1> p;
  p[0] = T(1);
  if constexpr (degree > 0) p[1] = x;
  for (int m = 1; m < degree; ++m) {
    p[m + 1] = (T(2 * m + 1) * x * p[m] - T(m) * p[m - 1]) / T(m + 1);
  }
  return p;
}

// Roots of P_s, ascending and exactly antisymmetric, by Newton from the asymptotic formula.
template <class T, int s>
Vector<T, s> legendre_roots() {
  Vector<T, s> roots;
  for (int i = 0; i < (s + 1) / 2; ++i) {
    T x = T(-std::cos(std::numbers::pi * (i + 0.75) / (s + 0.5)));
    if (2 * i + 1 == s) x = T(0);
    constexpr int kIterations = 8;  // quadratic from 1e-2: six reach 64 digits
    for (int iteration = 0; iteration < kIterations && 2 * i + 1 != s; ++iteration) {
      const auto p = legendre<T, s>(x);
      const T derivative = T(s) * (x * p[s] - p[s - 1]) / (x * x - T(1));
      x -= p[s] / derivative;
    }
    roots[i] = x;
    roots[s - 1 - i] = -x;
  }
  return roots;
}

template <class T, int s>
GaussTableau<T, s> make_gauss_tableau() {
  using Wide = std::conditional_t<std::is_same_v<T, double>, long double, T>;
  const Vector<Wide, s> x = legendre_roots<Wide, s>();
  const Wide half = Wide(1) / Wide(2);
  std::array<std::array<Wide, s + 1>, s> p;
  Vector<Wide, s> c;
  Vector<Wide, s> b;
  for (int i = 0; i < s; ++i) {
    p[i] = legendre<Wide, s>(x[i]);
    const Wide one_minus_x2 = (Wide(1) - x[i]) * (Wide(1) + x[i]);
    const Wide derivative = Wide(s) * p[i][s - 1];  // times 1 / (1 - x^2), since P_s(x) = 0
    c[i] = half * (Wide(1) + x[i]);
    b[i] = one_minus_x2 / (derivative * derivative);
    p[i][s] = Wide(0);
  }
  GaussTableau<T, s> tableau;
  for (int i = 0; i < s; ++i) {
    tableau.c[i] = T(c[i]);
    tableau.b[i] = T(b[i]);
    tableau.mu(i, i) = T(half);
    for (int j = 0; j < i; ++j) {
      Wide mu = c[i];
      for (int m = 1; m < s; ++m) mu += half * p[j][m] * (p[i][m + 1] - p[i][m - 1]);
      const bool lower_rounds = mu >= half;
      tableau.mu(i, j) = lower_rounds ? T(mu) : T(1) - T(Wide(1) - mu);
      tableau.mu(j, i) = T(1) - tableau.mu(i, j);
    }
    for (int j = 0; j < s; ++j) {
      Wide weight = b[i] / b[j];
      for (int k = 0; k < s; ++k) {
        if (k != j) weight *= (Wide(1) + c[i] - c[k]) / (c[j] - c[k]);
      }
      tableau.extrapolation(i, j) = T(weight);
    }
  }
  return tableau;
}

// One tableau per scalar and number of stages, made on first use.
template <class T, int s>
const GaussTableau<T, s>& gauss_tableau() {
  static const GaussTableau<T, s> kTableau = make_gauss_tableau<T, s>();
  return kTableau;
}

}  // namespace carnot
