#include "carnot/tableau/methods.h"

#include <stdexcept>

namespace carnot {

const std::vector<Method>& methods() {
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

const Method* find_method(std::string_view name) {
  if (name == "gauss2") name = "midpoint";
  for (const Method& method : methods()) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

const Method& method_of_name(std::string_view name) {
  const Method* const method = find_method(name);
  if (method != nullptr) return *method;
  throw std::invalid_argument("method " + std::string(name) + ": there is none of that name");
}

bool keeps_quadratic_invariants(const Method& method) {
  return method.symplectic && (method.family == kGaussFamily || method.family == kComposedFamily ||
                               method.family == kOwnFamily);
}

}  // namespace carnot
