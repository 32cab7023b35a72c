// What a search for geodesics gave, as JSON and as text.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/find_geodesics.h"
#include "run/delivery.h"
#include "run/ends.h"
#include "run/run_options.h"

namespace carnot::apps {

struct GeodesicRequest {
  Run run;
  Ends ends;
  GeodesicOptions options;
};

Result geodesic_result(const GeodesicRequest& request,
                       const GeodesicReport& report,
                       const std::vector<std::string>& arguments);

}  // namespace carnot::apps
