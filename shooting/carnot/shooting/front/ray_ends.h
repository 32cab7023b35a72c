// Where many rays are at one time.
#pragma once

#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// q at the time t of the rays with these momenta, n numbers each; NaN where the flow fails. They
// run side by side where the method has that; else with as many steps as those of `longest` need.
std::vector<double> ray_ends(const Dynamics& dynamics,
                             const std::vector<double>& from,
                             const std::vector<std::vector<double>>& momenta,
                             const std::vector<std::vector<double>>& longest,
                             double t,
                             int threads);

}  // namespace carnot::internal
