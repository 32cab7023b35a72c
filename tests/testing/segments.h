// Segments that tests of several files make. Where the program is built, it has compiled them.
#pragma once

#include <string_view>

#include "carnot/make_segment.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"

#ifdef CARNOT_TEST_SCENES_OF_PROGRAM
namespace carnot {

extern template Segment make_segment(const scenes::Unicycle&, std::string_view);
extern template Segment make_segment(const scenes::Vehicle&, std::string_view);
extern template Segment make_segment(const scenes::VehicleCosine&, std::string_view);

}  // namespace carnot
#endif
