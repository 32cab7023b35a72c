// The methods by name, with what is claimed of them; their tableaus hold the claims to account.
//
// The number in a name is the ORDER. "symplectic" and "symmetric" are declared here and can be
// measured: is_symplectic(), symplecticity_defect() and symmetry_defect() of the tableau
// (tableau_laws.h).
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

}  // namespace carnot
