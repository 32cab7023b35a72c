// Trajectories as CSV: one header line, 17 significant digits.
#pragma once

#include <string>
#include <vector>

#include "carnot/flow/trajectory.h"
#include "carnot/scene/scene_info.h"

namespace carnot::apps {

// Columns `geodesic` (the rank, from 1; only where there are several), `t`, `q_NAME`, `p_NAME`,
// `lambda_1`, ..., `hamiltonian`.
std::string csv_text(const SceneInfo& info,
                     int multipliers,
                     const std::vector<const Trajectory*>& trajectories);

}  // namespace carnot::apps
