// What counts as round-off, in one place.
//
// A double carries a relative error of kEpsilon, 2.2e-16, from each operation. What a computation
// of many operations leaves of a number that should vanish is a multiple of that, relative to the
// size of the numbers it is made of. The multiples below are powers of ten; each says of what it
// is.
#pragma once

#include <limits>

namespace carnot::internal {

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// A coordinate of two configurations that differs by less is equal: each of both was rounded once,
// and may have been moved to another frame and back.
inline constexpr double kSameCoordinate = 4 * kEpsilon;

// Of an orthonormal basis of a plane after one tangent flow, in coordinates where its angles are
// moderate.
inline constexpr double kPlaneRoundOff = 1e-14;
// Newton's method may move s = 0, the first point of a curve, by so much.
inline constexpr double kArclengthRoundOff = 1e-14;

// Of a flow over one segment, relative to the largest coordinate: where halving the step changes
// the end by less, more steps do not help.
inline constexpr double kFlowRoundOff = 1e-13;
// Singular values of dq(T)/dp(0) and eigenvalues of a plane's graph, relative to the largest:
// smaller ones are those of a singular matrix.
inline constexpr double kRankRoundOff = 1e-13;

// Of an end that a symmetry maps to an end, relative to one plus the coordinates.
inline constexpr double kSymmetryRoundOff = 1e-12;
// Of the constraints along a straight line that satisfies them, relative to its length.
inline constexpr double kConstraintRoundOff = 1e-12;
// Of a path that does not move: displacements, and momenta, that are smaller have no size.
inline constexpr double kRestRoundOff = 1e-12;
// Of the times at which segments meet, relative to T.
inline constexpr double kTimeRoundOff = 1e-12;

}  // namespace carnot::internal
