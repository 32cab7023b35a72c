// The system of a scene, of whichever kind.
#pragma once

#include "carnot/system/generalized_hamiltonian.h"
#include "carnot/system/lagrangian_system.h"
#include "carnot/system/optimal_control.h"
#include "carnot/system/velocity_constraints.h"

namespace carnot {

// The adapter that turns the scene into H(t, q, p, y).
template <class Scene>
auto make_system(const Scene& scene) {
  if constexpr (VelocityConstrainedScene<Scene>) {
    return VelocityConstraints<Scene>(scene);
  } else if constexpr (LagrangianScene<Scene>) {
    return LagrangianSystem<Scene>(scene);
  } else if constexpr (OptimalControlScene<Scene>) {
    return OptimalControl<Scene>(scene);
  } else {
    static_assert(GeneralizedHamiltonianScene<Scene>, "a scene of no known kind");
    return GeneralizedHamiltonian<Scene>(scene);
  }
}

}  // namespace carnot
