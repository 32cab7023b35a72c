// The scenes that every law is tried on.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <type_traits>

#include "carnot/scenes/heisenberg.h"
#include "carnot/scenes/heisenberg_group.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"

namespace carnot::test {

using Scenes = ::testing::Types<scenes::Vehicle,
                                scenes::VehicleCosine,
                                scenes::Heisenberg,
                                scenes::HeisenbergGroup,
                                scenes::Unicycle>;

// V = 0.
using FreeScenes = ::testing::
    Types<scenes::Vehicle, scenes::Heisenberg, scenes::HeisenbergGroup, scenes::Unicycle>;
// M(q) has an inverse.
using RegularMassScenes =
    ::testing::Types<scenes::Vehicle, scenes::VehicleCosine, scenes::Heisenberg, scenes::Unicycle>;
// Rigid motions of the plane are symmetries.
using PlanarScenes = ::testing::Types<scenes::Vehicle, scenes::Unicycle>;

// Names for TYPED_TEST_SUITE: letters only.
struct SceneNames {
  template <class Scene>
  static std::string GetName(int /*index*/) {
    std::string name = Scene{}.info().name;
    name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
    return name;
  }
};

// The scene with parameters that are all different, so that no factor 1 hides a mistake.
template <class Scene>
Scene uneven() {
  constexpr scenes::Vehicle kVehicle{0.7, 0.4, 1.3};
  if constexpr (std::is_same_v<Scene, scenes::Vehicle>) {
    return kVehicle;
  } else if constexpr (std::is_same_v<Scene, scenes::VehicleCosine>) {
    return {kVehicle};
  } else if constexpr (std::is_same_v<Scene, scenes::Unicycle>) {
    return {0.6};
  } else {
    return {};
  }
}

}  // namespace carnot::test
