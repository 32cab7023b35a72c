// How far along their line momenta matter: beyond, extremals turn ever faster and are conjugate
// ever earlier.
#pragma once

#include <vector>

#include "carnot/shooting/front/unit_momenta.h"

namespace carnot::internal {

// The least |w|, to 2 per cent, from which on all extremals are conjugate before the time `target`,
// by sixteen rays on either side. Infinite where there is no such w up to 256 / target: beyond,
// steps become too short for a mesh.
double conjugate_bound(const Dynamics& dynamics,
                       const std::vector<double>& from,
                       const UnitMomenta& momenta,
                       double target,
                       int threads);

}  // namespace carnot::internal
