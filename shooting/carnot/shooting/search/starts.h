// Paths to start a relaxation from.
//
// The straight line, then straight lines plus a wiggle, sum_m a_m sin(m pi s) in every coordinate.
// Every fourth start is designed while there are any left: the first mode in one coordinate, the
// second in another, each with either sign. Such a path encloses area in the plane of the two,
// which is how brackets of the admissible directions are made; a change of sign is its mirror
// image. The rest are random combinations, each from its own generator, so that start i is the same
// whatever else is computed. Nothing depends on where the origin is.
//
// Scale: with D the length of the straight line in the metric M and S the length of one radian,
// the wiggle has size S (D/S)^e, e = 1/3, 1/2, 1 in turn: a displacement of size D that needs
// brackets of order r costs a path of length D^(1/r). Where the straight line violates the
// constraints and is short, e = 1 is hopeless and is left out. A wiggle that leaves the chart is
// made smaller, unless the straight line does. Paths are brought to the manifold of holonomic
// constraints.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/path/relaxation.h"

namespace carnot::internal {

struct Start {
  Path path;
  RelaxationOptions relaxation;
};

// Number i of the sequence that belongs to `seed`, on a grid of `intervals`.
Start make_start(const BoundaryValueProblem& problem,
                 std::uint64_t seed,
                 int i,
                 int intervals = 32);

}  // namespace carnot::internal
