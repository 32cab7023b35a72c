// Continuation: a geodesic followed while the target, the start, T or the scene changes.
//
// The solutions of the shooting equations along a line of problems (problem_line.h) form curves.
// One is followed by pseudo-arclength (solution_curve.h), so folds, where s turns back, are passed.
// The step grows and shrinks with the curvature and with how well Newton's method does. Every point
// is verified as any geodesic is, and labelled. Where |dz(T)/dp(0)| grows, knots are added.
//
// Where the problems have limits, s only goes up, from an extremal that is a minimum or meets no
// limit, and arcs on limits come and go (limited_tracer.h). Folds and branch points are not looked
// for there.
//
// Where only the target moves, dF/dp(0) = dq(T)/dp(0): T is a conjugate time at a fold and at a
// branch point, the Morse index changes there, and nowhere else.
#pragma once

#include <string>
#include <vector>

#include "carnot/shooting/continue/continuation_report.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/problem/problem_line.h"

namespace carnot {

// From `start`, an extremal of line.at(0), where the branch goes towards larger s. If it was
// verified at knots, or there are limits, it must come with a trajectory of 64 k + 1 samples.
// Throws std::invalid_argument on bad input; numerical failure is a status. Holonomic constraints,
// where momenta along the rows of Dh move nothing, are bad input.
ContinuationReport continue_geodesic(const ProblemLine& line,
                                     const Geodesic& start,
                                     const ContinuationOptions& options = {});

}  // namespace carnot
