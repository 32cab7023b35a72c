// Dynamics of a scene with holonomic constraints, which RATTLE keeps.
#pragma once

#include <string_view>

#include "carnot/flow/rattle_kernel.h"
#include "carnot/make_dynamics.h"

namespace carnot {

// As make_dynamics(). RATTLE runs in a kernel that is compiled with the scene, which takes several
// times as long.
template <class Scene>
Dynamics make_rattle_dynamics(const Scene& scene, std::string_view name = default_method<Scene>()) {
  using namespace dynamics_calls;
  static_assert(HasHolonomic<Scene>, "without holonomic constraints: make_dynamics()");
  using System = decltype(make_system(scene));
  const Method& method = method_for(scene, name);
  if constexpr (IsProduct<Scene>) {
    if (method.family != kRattleFamily) {
      static_assert(kHasCompiledKernel<Scene>);
      return with_compiled_kernel(scene, method, method);
    }
  }
  Dynamics dynamics = bind(scene, method, SystemOnBranch<System>{make_system(scene)});
  dynamics.kernel = make_rattle_kernel<System>(method, periods_of(dynamics.info));
  return dynamics;
}

// The same with a method of one's own (own_method.h), for scenes whose constraints are quadratic:
// symplectic methods with one tableau keep these. Others are refused with std::invalid_argument.
template <class Scene>
Dynamics make_rattle_dynamics(const Scene& scene, const OwnMethod& own) {
  using namespace dynamics_calls;
  static_assert(HasHolonomic<Scene>, "without holonomic constraints: make_dynamics()");
  static_assert(IsProduct<Scene>, "only RATTLE keeps the holonomic constraints of this scene");
  check_method(scene, own.method);
  return with_compiled_kernel(scene, own.method, own.tableau);
}

}  // namespace carnot
