// Paths to start a relaxation from.
//
// The first is the straight line. The others are the straight line plus a wiggle, which is
// sum_m a_m sin(m pi s) in every coordinate. Every fourth start is designed while there are any
// left: it has the first mode in one coordinate and the second in another, each with either sign.
// Such a path encloses area in the plane of the two, which is how brackets of the admissible
// directions are made; a change of sign is its mirror image. The rest are random combinations,
// of few modes or of many in turn. Each has a generator of its own, so that start i is the same
// whatever else is computed. Nothing depends on where the origin is.
//
// The scale: let D be the length of the straight line in the metric M, and S the length of one
// radian. The wiggle has the size S (D/S)^e with e = 1/3, 1/2, 1 in turn, because a displacement of
// size D that needs brackets of order r costs a path of length D^(1/r). Where the straight line
// violates the constraints and is short, e = 1 is hopeless and is left out. A wiggle that leaves
// the chart is made smaller, unless the straight line leaves it, too. Where there are holonomic
// constraints, the nodes are brought to their manifold. Free coordinates of the ends are drawn
// around where they are looked for first.
#pragma once

#include <cstdint>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/path/relaxation.h"
#include "carnot/shooting/problem/scales.h"

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
// The same of a problem whose scales are known.
Start make_start(const BoundaryValueProblem& problem,
                 const StartScales& scales,
                 std::uint64_t seed,
                 int i,
                 int intervals);

}  // namespace carnot::internal
