// Which symmetry of the scene takes an extremal to another one that meets it.
//
// Where two extremals of the same length meet, a point is said to be in the Maxwell set. Mostly a
// symmetry makes such a pair.
#pragma once

#include "carnot/shooting/rays/meeting.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {

enum class PairSymmetry { kNone, kMirror, kReversal, kMirrorAndReversal };

// Of a ray and a rival that it meets at the time t. Cost: a few flows.
PairSymmetry symmetry_of_pair(const Ray& ray, double t, const Rival& rival);

}  // namespace carnot::internal
