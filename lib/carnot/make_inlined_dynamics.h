// Dynamics whose kernel knows its scene, whatever the number of coordinates.
#pragma once

#include <string_view>

#include "carnot/flow/inlined_kernel.h"
#include "carnot/make_dynamics.h"
#include "carnot/tableau/make_tableau.h"

namespace carnot {

namespace dynamics_calls {

// A Dynamics whose kernel is compiled with its scene.
template <class Scene>
Dynamics with_inlined_kernel(const Scene& scene,
                             const Method& method,
                             const Tableau<double>& tableau) {
  static_assert(!HasHolonomic<Scene>,
                "holonomic constraints: make_rattle_dynamics() of <carnot/make_rattle_dynamics.h>");
  using System = decltype(make_system(scene));
  Dynamics dynamics =
      bind(scene, method, SystemOnBranch<System>{make_system(scene)}, functions_of<System>());
  dynamics.kernel = make_inlined_kernel<System>(tableau, periods_of(dynamics.info));
  return dynamics;
}

}  // namespace dynamics_calls

// As make_dynamics(), with a kernel that is compiled with the scene, which takes several times as
// long. What that is worth below kMostCompiled coordinates depends on the scene (erased_system.h).
template <class Scene>
Dynamics make_inlined_dynamics(const Scene& scene,
                               std::string_view name = default_method<Scene>()) {
  using namespace dynamics_calls;
  const Method& method = method_for(scene, name);
  return with_inlined_kernel(scene, method, make_tableau(method));
}

// The same with a method of one's own (own_method.h).
template <class Scene>
Dynamics make_inlined_dynamics(const Scene& scene, const OwnMethod& own) {
  dynamics_calls::check_method(scene, own.method);
  return dynamics_calls::with_inlined_kernel(scene, own.method, own.tableau);
}

}  // namespace carnot
