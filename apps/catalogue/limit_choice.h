// Limits and obstacles as the command line names them: --limit 'EXPRESSION in A:B', --disc X,Y,R.
#pragma once

#include <string>
#include <vector>

#include "carnot/scene/limit.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

// The limits that the scene has by itself, then those that are asked for. Their formulas are in the
// coordinates and parameters of the scene's text. Throws std::invalid_argument.
std::vector<Limit> choose_limits(const SceneEntry& entry,
                                 const ParameterValues& parameters,
                                 const std::vector<std::string>& limits,
                                 const std::vector<std::string>& discs);

}  // namespace carnot::apps
