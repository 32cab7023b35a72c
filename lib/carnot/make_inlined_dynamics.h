// Dynamics whose kernel knows its scene, whatever the number of coordinates.
#pragma once

#include <string_view>

#include "carnot/flow/inlined_kernel.h"
#include "carnot/make_dynamics.h"

namespace carnot {

// As make_dynamics(), with a kernel that is compiled with the scene, which takes several times as
// long. What that is worth below kMostCompiled coordinates depends on the scene (erased_system.h).
template <class Scene>
Dynamics make_inlined_dynamics(const Scene& scene,
                               std::string_view name = default_method<Scene>()) {
  using namespace dynamics_calls;
  static_assert(!HasHolonomic<Scene>,
                "holonomic constraints: make_rattle_dynamics() of <carnot/make_rattle_dynamics.h>");
  using System = decltype(make_system(scene));
  const Method& method = method_for(scene, name);
  Dynamics dynamics =
      bind(scene, method, SystemOnBranch<System>{make_system(scene)}, functions_of<System>());
  dynamics.kernel = make_inlined_kernel<System>(method, periods_of(dynamics.info));
  return dynamics;
}

}  // namespace carnot
