#include "carnot/shooting/front/front_mesh.h"

#include <algorithm>
#include <array>

namespace carnot {

const char* name_of(FrontLabel label) {
  constexpr std::array<const char*, kFrontLabels> kNames{"front",
                                                         "sphere",
                                                         "caustic",
                                                         "cut",
                                                         "conjugate",
                                                         "maxwell",
                                                         "maxwell by mirror",
                                                         "maxwell by reversal",
                                                         "maxwell by mirror and reversal",
                                                         "cusp",
                                                         "swallowtail",
                                                         "hyperbolic umbilic",
                                                         "elliptic umbilic",
                                                         "unknown"};
  return kNames[static_cast<std::size_t>(label)];
}

bool is_maxwell(FrontLabel label) {
  return label >= FrontLabel::kMaxwell && label <= FrontLabel::kMaxwellByMirrorAndReversal;
}

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
