#include "geodesic/geodesic_request.h"

#include <utility>

#include "catalogue/scene_choice.h"
#include "text/numbers.h"

namespace carnot::apps {

GeodesicRequest check(const GeodesicCall& options) { return check(options, check(options.run)); }

GeodesicRequest check(const GeodesicCall& options, Run run) {
  GeodesicRequest request;
  request.run = std::move(run);
  request.ends = parse_ends(options.from, options.to, options.time, request.run);
  request.ends.limits = limits_of(options.search.asked, request.run);
  request.options = check(options.search, request.run);
  if (!options.guess.empty()) {
    request.options.guess =
        parse_vector("--guess", options.guess, coordinate_names(*request.run.entry));
  }
  return request;
}

}  // namespace carnot::apps
