// The methods by name, with what is claimed of them; their tableaus hold the claims to account.
//
// The number in a name is the ORDER. "symplectic" and "symmetric" are declared here and can be
// measured: is_symplectic(), symplecticity_defect() and symmetry_defect() of the tableau.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "carnot/tableau/composition_tableau.h"
#include "carnot/tableau/dop853_tableau.h"
#include "carnot/tableau/gauss_tableau.h"
#include "carnot/tableau/lobatto_tableau.h"
#include "carnot/tableau/radau_tableau.h"

namespace carnot {

struct Method {
  std::string name;
  std::string family;  // one of those below
  int order = 0;
  int stages = 0;
  bool symplectic = false;
  bool symmetric = false;
  std::string summary;  // one line
};

inline constexpr const char* kGaussFamily = "Gauss";
inline constexpr const char* kComposedFamily = "midpoint composition";
inline constexpr const char* kLobattoFamily = "Lobatto IIIA-IIIB";
inline constexpr const char* kRadauFamily = "Radau IIA";
inline constexpr const char* kDop853Family = "Dormand-Prince";
// Composed steps of a holonomic system: each stage is a RATTLE step, b_i h its length.
inline constexpr const char* kRattleFamily = "RATTLE";

// The tableau of a method of methods().
template <class T = double>
Tableau<T> make_tableau(const Method& method) {
  if (method.family == kGaussFamily) return gauss_tableau<T>(method.stages);
  if (method.family == kLobattoFamily) return lobatto_tableau<T>(method.stages);
  if (method.family == kRadauFamily) return radau_tableau<T>(method.stages);
  if (method.family == kDop853Family) return dop853_tableau<T>();
  assert(method.family == kComposedFamily || method.family == kRattleFamily);
  return composition_tableau<T>(method.order);
}

// All of them, in the order of a list.
inline const std::vector<Method>& methods() {
  static const std::vector<Method> kMethods = {
      {"midpoint", kGaussFamily, 2, 1, true, true, "implicit midpoint rule, also called gauss2"},
      {"gauss4", kGaussFamily, 4, 2, true, true, "collocation at Gauss nodes"},
      {"gauss6", kGaussFamily, 6, 3, true, true, "collocation at Gauss nodes"},
      {"gauss8", kGaussFamily, 8, 4, true, true, "collocation at Gauss nodes"},
      {"gauss10", kGaussFamily, 10, 5, true, true, "collocation at Gauss nodes"},
      {"gauss12", kGaussFamily, 12, 6, true, true, "collocation at Gauss nodes"},
      {"gauss14", kGaussFamily, 14, 7, true, true, "collocation at Gauss nodes"},
      {"gauss16", kGaussFamily, 16, 8, true, true, "collocation at Gauss nodes"},
      {"gauss18", kGaussFamily, 18, 9, true, true, "collocation at Gauss nodes"},
      {"gauss20", kGaussFamily, 20, 10, true, true, "collocation at Gauss nodes"},
      {"gauss22", kGaussFamily, 22, 11, true, true, "collocation at Gauss nodes"},
      {"gauss24", kGaussFamily, 24, 12, true, true, "collocation at Gauss nodes"},
      {"midpoint4", kComposedFamily, 4, 5, true, true, "diagonally implicit: 5 midpoint steps"},
      {"midpoint6", kComposedFamily, 6, 9, true, true, "diagonally implicit: 9 midpoint steps"},
      {"midpoint8", kComposedFamily, 8, 17, true, true, "diagonally implicit: 17 midpoint steps"},
      {"lobatto2", kLobattoFamily, 2, 2, true, true, "Stoermer-Verlet: IIIA for q, IIIB for p"},
      {"lobatto4", kLobattoFamily, 4, 3, true, true, "partitioned: IIIA for q, IIIB for p"},
      {"lobatto6", kLobattoFamily, 6, 4, true, true, "partitioned: IIIA for q, IIIB for p"},
      {"lobatto8", kLobattoFamily, 8, 5, true, true, "partitioned: IIIA for q, IIIB for p"},
      {"radau3", kRadauFamily, 3, 2, false, false, "collocation, damping; for contrast"},
      {"radau5", kRadauFamily, 5, 3, false, false, "collocation, damping; for contrast"},
      {"radau9", kRadauFamily, 9, 5, false, false, "collocation, damping; for contrast"},
      {"dop853", kDop853Family, 8, 12, false, false, "explicit, constant steps; for contrast"},
      {"rattle", kRattleFamily, 2, 1, true, true, "for holonomic constraints; midpoint inside"},
      {"rattle4", kRattleFamily, 4, 5, true, true, "for holonomic constraints: 5 rattle steps"},
      {"rattle6", kRattleFamily, 6, 9, true, true, "for holonomic constraints: 9 rattle steps"}};
  return kMethods;
}

// nullptr where there is none of the name. "gauss2" is the midpoint rule.
inline const Method* find_method(std::string_view name) {
  if (name == "gauss2") name = "midpoint";
  for (const Method& method : methods()) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

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
