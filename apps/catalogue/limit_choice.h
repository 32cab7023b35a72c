// Limits and obstacles as the command line names them: --limit 'EXPRESSION in A:B', --disc X,Y,R.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carnot/scene/limit.h"
#include "catalogue/scene_entry.h"

namespace carnot::apps {

// As they are typed.
struct AskedLimits {
  std::vector<std::string> limits;
  std::vector<std::string> discs;

  [[nodiscard]] bool any() const { return !limits.empty() || !discs.empty(); }
};

// The limits that the scene has by itself, then those that are asked for. Their formulas are in the
// coordinates and parameters of the scene's text. Throws std::invalid_argument.
std::vector<Limit> choose_limits(const SceneEntry& entry,
                                 const ParameterValues& parameters,
                                 const AskedLimits& asked);

// The centre and radius of a disc. Throws std::invalid_argument.
std::vector<double> parse_disc(std::string_view option, const std::string& text);

}  // namespace carnot::apps
