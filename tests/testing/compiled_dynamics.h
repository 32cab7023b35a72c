// Dynamics that tests of several files make. Where the program is built, it has compiled them.
#pragma once

#include <string_view>

#include "carnot/make_dynamics.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"

#ifdef CARNOT_TEST_SCENES_OF_PROGRAM
namespace carnot {

extern template Dynamics make_dynamics(const scenes::Unicycle&, std::string_view);
extern template Dynamics make_dynamics(const scenes::Vehicle&, std::string_view);
extern template Dynamics make_dynamics(const scenes::VehicleCosine&, std::string_view);

}  // namespace carnot
#endif
