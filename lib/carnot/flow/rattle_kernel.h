// The kernel of RATTLE and its compositions, which knows its system.
#pragma once

#include <span>

#include "carnot/flow/kernel.h"
#include "carnot/step/rattle.h"
#include "carnot/step/rattle_tangent.h"
#include "carnot/tableau/make_tableau.h"

namespace carnot {

template <class System>
Kernel make_rattle_kernel(const Method& method, std::span<const double> periods) {
  using namespace kernel;
  using M = Direct<Rattle<System>>;
  return kernel_of(M{make_tableau(method), winding_of<System::kDof>(periods)});
}

}  // namespace carnot
