// What a search for geodesics gave, as JSON and as text.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "geodesic/geodesic_request.h"
#include "run/delivery.h"

namespace carnot::apps {

Result geodesic_result(const GeodesicRequest& request,
                       const GeodesicReport& report,
                       const std::vector<std::string>& arguments);

}  // namespace carnot::apps
