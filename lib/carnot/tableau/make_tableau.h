// The coefficients of a method by name.
#pragma once

#include <cassert>

#include "carnot/tableau/composition_tableau.h"
#include "carnot/tableau/dop853_tableau.h"
#include "carnot/tableau/gauss_tableau.h"
#include "carnot/tableau/lobatto_tableau.h"
#include "carnot/tableau/methods.h"
#include "carnot/tableau/radau_tableau.h"

namespace carnot {

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

}  // namespace carnot
