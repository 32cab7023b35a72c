// How a vertex is called at which an extremal meets another one.
#pragma once

#include <array>

#include "carnot/shooting/front/front_mesh.h"
#include "carnot/shooting/rays/pair_symmetry.h"

namespace carnot::internal {

inline FrontLabel maxwell_label(const Ray& ray, double t, const Rival& rival) {
  constexpr std::array kLabels{FrontLabel::kMaxwell,
                               FrontLabel::kMaxwellByMirror,
                               FrontLabel::kMaxwellByReversal,
                               FrontLabel::kMaxwellByMirrorAndReversal};
  return kLabels[static_cast<std::size_t>(symmetry_of_pair(ray, t, rival))];
}

}  // namespace carnot::internal
