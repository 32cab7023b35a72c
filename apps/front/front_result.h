// What is said of fronts and cut times, as JSON and as text.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/cut_time.h"
#include "carnot/shooting/wavefront.h"
#include "front/front_request.h"
#include "run/delivery.h"

namespace carnot::apps {

Result cut_time_result(const FrontRequest& request,
                       const CutTime& cut,
                       const std::vector<std::string>& arguments);

// What became of the surfaces, one for each length; the file that is asked for holds them.
Result surfaces_result(const FrontRequest& request,
                       const std::vector<FrontMesh>& meshes,
                       const std::vector<std::string>& arguments);

}  // namespace carnot::apps
