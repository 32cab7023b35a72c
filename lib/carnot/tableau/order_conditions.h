// The simplifying assumptions of a Runge-Kutta method, as defects in long double:
//
//   B(p): sum_j b_j c_j^{k-1} = 1/k,                    k = 1..p
//   C(q): sum_j a_ij c_j^{k-1} = c_i^k / k,             k = 1..q, all i
//   D(r): sum_i b_i c_i^{k-1} a_ij = b_j (1 - c_j^k)/k, k = 1..r, all j
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.7.
#pragma once

#include <algorithm>
#include <cmath>

#include "carnot/tableau/tableau.h"

namespace carnot {

enum class Part { kPosition, kMomentum };  // of a partitioned method

// a_ij = mu_ij omega_j.
template <class T>
StageMatrix<long double, kAnyStages> coefficients_of(const Tableau<T>& tableau,
                                                     Part part = Part::kPosition) {
  const int s = tableau.stages();
  StageMatrix<long double, kAnyStages> a(s, s);
  for (int i = 0; i < s; ++i) {
    for (int j = 0; j < s; ++j) {
      const T mu = part == Part::kPosition ? tableau.mu(i, j) : tableau.momentum_mu(i, j);
      a(i, j) = static_cast<long double>(mu) * static_cast<long double>(tableau.omega[j]);
    }
  }
  return a;
}

// x^exponent, with 0^0 = 1.
template <class T>
long double power_of(const T& x, int exponent) {
  return exponent == 0 ? 1 : std::pow(static_cast<long double>(x), exponent);
}

// |k sum_j b_j c_j^{k-1} - 1|.
template <class T>
long double quadrature_defect(const Tableau<T>& tableau, int k) {
  long double sum = 0;
  for (int j = 0; j < tableau.stages(); ++j) sum += tableau.b[j] * power_of(tableau.c[j], k - 1);
  return std::abs(static_cast<long double>(k) * sum - 1);
}

// Of C, times k: the largest over the stages i >= first.
template <class T>
long double stage_defect(const Tableau<T>& tableau,
                         int k,
                         Part part = Part::kPosition,
                         int first = 0) {
  const auto a = coefficients_of(tableau, part);
  long double defect = 0;
  for (int i = first; i < tableau.stages(); ++i) {
    long double sum = 0;
    for (int j = 0; j < tableau.stages(); ++j) sum += a(i, j) * power_of(tableau.c[j], k - 1);
    defect =
        std::max(defect, std::abs(static_cast<long double>(k) * sum - power_of(tableau.c[i], k)));
  }
  return defect;
}

// Of D, times k: the largest over j.
template <class T>
long double transposed_defect(const Tableau<T>& tableau, int k, Part part = Part::kPosition) {
  const auto a = coefficients_of(tableau, part);
  long double defect = 0;
  for (int j = 0; j < tableau.stages(); ++j) {
    long double sum = 0;
    for (int i = 0; i < tableau.stages(); ++i) {
      sum += tableau.b[i] * power_of(tableau.c[i], k - 1) * a(i, j);
    }
    const long double exact = tableau.b[j] * (1 - power_of(tableau.c[j], k));
    defect = std::max(defect, std::abs(static_cast<long double>(k) * sum - exact));
  }
  return defect;
}

}  // namespace carnot
