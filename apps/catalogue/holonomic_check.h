// Configurations must lie on the holonomic constraints of their scene, and be regular at an end.
#pragma once

#include <string_view>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::apps {

// Throws std::invalid_argument where h(q) is more than round-off of what a person types.
void check_holonomic(std::string_view option,
                     std::string_view text,
                     const HolonomicResiduals& residuals);

// The same for an end q of a geodesic, where constraints must be independent and coordinates
// regular, too.
void check_end(std::string_view option,
               std::string_view text,
               const Dynamics& dynamics,
               const std::vector<double>& q);

}  // namespace carnot::apps
