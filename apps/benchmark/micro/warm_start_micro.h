// Warm starts beside the flows that they are made of.
#pragma once

namespace carnot::apps {

// warm/flow, warm/tangent: one flow and one tangent flow of a geodesic with the steps that a
// tolerance of 1e-10 asks for; warm/solve-D: a geodesic to a target up to D away in each
// coordinate.
void add_warm_starts();

}  // namespace carnot::apps
