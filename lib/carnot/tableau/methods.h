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
// Those of own_method.h.
inline constexpr const char* kOwnFamily = "own";
inline constexpr const char* kOwnPartitionedFamily = "own, partitioned";

// Whether it keeps quadratic invariants.
bool keeps_quadratic_invariants(const Method& method);

// All of them, in the order of a list.
const std::vector<Method>& methods();

// nullptr where there is none of the name. "gauss2" is the midpoint rule.
const Method* find_method(std::string_view name);

// The same; throws std::invalid_argument where there is none.
const Method& method_of_name(std::string_view name);

}  // namespace carnot
