#include "carnot/shooting/front/front_mesh.h"

#include <algorithm>

namespace carnot {

std::vector<int> seen_coordinates(const Dynamics& dynamics, const FrontOptions& options) {
  if (!options.project.empty()) return options.project;
  const int told =
      options.section ? std::max(options.section->coordinate, options.section->equal) : -1;
  std::vector<int> seen;
  for (int k = 0; seen.size() < 3 && k < dynamics.dof; ++k) {
    if (k != told) seen.push_back(k);
  }
  return seen;
}

}  // namespace carnot
