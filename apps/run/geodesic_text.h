// What every subcommand that finds geodesics says of one.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/geodesic.h"
#include "run/ends.h"
#include "run/run_options.h"

namespace carnot::apps {

// "locally-minimal" and so on; "single", "knots" or "grid".
const char* name_of(Label label);
const char* name_of(Verification verification);

// How the JSON of such a subcommand begins: up to "method".
Json problem_json(const std::vector<std::string>& arguments, const Run& run, const Ends& ends);

// Adds "limits" and "limit_violation" where there are limits.
void add_limits(const Geodesic& geodesic, const Ends& ends, Json& json);

// Adds "p0" to "knot_defect" and, where ends are free, what was found there.
void add_extremal(const Geodesic& geodesic, const Ends& ends, Json& json);

// All of it but the trajectory; `rank` is its place in the list, from 1.
Json geodesic_json(const Geodesic& geodesic, const Ends& ends, std::size_t rank);

// Its action, length, error and label, for people.
std::vector<std::string> geodesic_cells(const Geodesic& geodesic);

}  // namespace carnot::apps
