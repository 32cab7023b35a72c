// Crossings: paths that begin as one discrete extremal and end as another.
//
// Where a path has to go round many times there are hundreds of extremals. They differ in what they
// do early and in what they do late, and a random start is seldom good at both. A crossing has the
// one from one extremal and the other from a second one, as genetic algorithms do it (Holland,
// Adaptation in Natural and Artificial Systems, 1975). Like every other start it is relaxed and
// tightened then.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/path/path.h"

namespace carnot::internal {

// Crossing number `i` of the sequence that belongs to `seed`, on a grid of `intervals`. There are
// two parents or more, those of less action first: they are drawn more often. The crossing begins
// where the one begins and ends where the other ends. It has no multipliers and no momenta.
Path crossing(const std::vector<const Path*>& parents, std::uint64_t seed, int i, int intervals);

}  // namespace carnot::internal
