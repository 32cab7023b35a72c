// Where extremals lead, and the derivatives of that by their momenta, several extremals at once.
//
// An extremal takes n + 1 lanes of a pack: its own, and one for each momentum, moved by a small
// difference. All lanes make the same steps, so that the errors of the method cancel in the
// differences, and a coarse tolerance serves: what Newton's method needs of a Jacobian are three or
// four digits. A tangent flow of Gauss gives more, at three to five times the cost: unicycles with
// momenta of size 4 take 75 us of it, and 30 us of a pack, which serves two of them (Zen 3, AVX2).
#pragma once

#include <span>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

struct PackedTangent {
  bool known = false;
  SmallVector q1;  // q(T), to the coarse tolerance
  SmallMatrix j;   // dq(T)/dp(0)
  SmallMatrix k;   // dp(T)/dp(0)
};

// How many extremals fill a pack; 0 where the scene or the method has no packs.
int packed_extremals(const Dynamics& dynamics);

// Of the extremals from `problem.from` with these momenta, at most packed_extremals() of them.
// Where one lane fails, nothing is known of any.
void packed_tangents(const BoundaryValueProblem& problem,
                     std::span<const SmallVector> p0,
                     std::span<PackedTangent> tangents);

}  // namespace carnot::internal
