// The kernel of RATTLE and its compositions, which knows its system.
#pragma once

#include <cassert>
#include <span>

#include "carnot/flow/kernel.h"
#include "carnot/step/rattle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/tableau/composition_tableau.h"
#include "carnot/tableau/methods.h"

namespace carnot {

template <class System>
Kernel make_rattle_kernel(const Method& method, std::span<const double> periods) {
  using namespace kernel;
  using M = Direct<Rattle<System>>;
  assert(method.family == kRattleFamily);
  return kernel_of(M{composition_tableau<double>(method.order), winding_of<System::kDof>(periods)});
}

}  // namespace carnot
