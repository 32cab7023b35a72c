// What an atlas keeps of a problem: one object of JSON, on one line of the journal.
//
// {"index", "from", "to", "time", "parameters" (those that differ), "status", "reason", "message",
// "geodesics": [as of `carnot geodesic`], "starts", "missed_estimate", "seconds"}.
#pragma once

#include <string>
#include <vector>

#include "atlas/problem_list.h"
#include "carnot/shooting/find_geodesics.h"
#include "carnot/shooting/solve_field.h"

namespace carnot::apps {

// `problem.ends` with its limits.
Json atlas_record(long index,
                  const AtlasProblem& problem,
                  const std::vector<std::string>& parameters,
                  const GeodesicReport& report);

// The same of a point of a field.
Json field_record(long index, const AtlasProblem& problem, const Field& field);

}  // namespace carnot::apps
