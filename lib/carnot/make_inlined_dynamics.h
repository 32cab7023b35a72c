// Dynamics whose default method knows its scene. What that is worth depends on the scene, see
// erased_system.h; the scene takes several times as long to compile.
#pragma once

#include <string_view>
#include <vector>

#include "carnot/flow/inlined_kernel.h"
#include "carnot/make_dynamics.h"

namespace carnot {

// The same as make_dynamics(), with a kernel of its own where the method is gauss16.
template <class Scene>
Dynamics make_inlined_dynamics(const Scene& scene,
                               std::string_view name = default_method<Scene>()) {
  using System = decltype(make_system(scene));
  Dynamics dynamics = make_dynamics(scene, name);
  const Method& method = dynamics_calls::method_for(scene, name);
  if constexpr (!kNeedsRattle<Scene>) {
    if (has_fixed_kernel(method)) {
      dynamics.kernel =
          make_fixed_kernel<System>(method, dynamics_calls::periods_of(dynamics.info));
    }
  }
  return dynamics;
}

}  // namespace carnot
