#include "carnot/scene/unit_sizes.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace carnot {

std::vector<double> sizes_by_unit(const SceneInfo& info, std::span<const double> x, double least) {
  const auto unit = [&](std::size_t j) {
    return j < info.configuration.size() ? info.configuration[j].unit : std::string();
  };
  std::vector<double> sizes(x.size(), 0.0);
  for (std::size_t j = 0; j < x.size(); ++j) {
    if (unit(j) == "1" || unit(j) == "rad") sizes[j] = least;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (unit(i) == unit(j)) sizes[j] = std::max(sizes[j], std::abs(x[i]));
    }
  }
  return sizes;
}

}  // namespace carnot
