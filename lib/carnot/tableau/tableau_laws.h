// The identities that make a method symplectic and symmetric, as defects.
#pragma once

#include <algorithm>
#include <cmath>

#include "carnot/tableau/tableau.h"

namespace carnot {

// max |b_i a^_ij + b_j a_ji - b_i b_j|, a^ of p: zero for a symplectic method.
template <class T, int s>
T symplecticity_defect(const Tableau<T, s>& tableau) {
  using std::abs;
  T defect(0);
  for (int i = 0; i < tableau.stages(); ++i) {
    for (int j = 0; j < tableau.stages(); ++j) {
      const T sum = tableau.b[i] * tableau.momentum_mu(i, j) * tableau.omega[j] +
                    tableau.b[j] * tableau.mu(j, i) * tableau.omega[i];
      defect = std::max(defect, T(abs(sum - tableau.b[i] * tableau.b[j])));
    }
  }
  return defect;
}

// max |b_i - b_i'| and |a_ij + a_i'j' - b_j| with i' = s + 1 - i: zero where the step of -h undoes
// the step of h with the same stages in reverse order.
template <class T, int s>
T symmetry_defect(const Tableau<T, s>& tableau) {
  using std::abs;
  const int last = tableau.stages() - 1;
  T defect(0);
  for (int i = 0; i <= last; ++i) {
    defect = std::max(defect, T(abs(tableau.b[i] - tableau.b[last - i])));
    for (int j = 0; j <= last; ++j) {
      const T q = tableau.mu(i, j) * tableau.omega[j] +
                  tableau.mu(last - i, last - j) * tableau.omega[last - j];
      const T p = tableau.momentum_mu(i, j) * tableau.omega[j] +
                  tableau.momentum_mu(last - i, last - j) * tableau.omega[last - j];
      defect = std::max(defect, std::max(T(abs(q - tableau.b[j])), T(abs(p - tableau.b[j]))));
    }
  }
  return defect;
}

}  // namespace carnot
