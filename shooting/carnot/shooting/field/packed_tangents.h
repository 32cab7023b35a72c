// Where extremals lead, and the derivatives of that by their momenta, several extremals at once.
//
// For derivatives an extremal takes n lanes of a pack: its own, and n - 1 with one momentum moved
// by a small difference. All lanes make the same steps, so that the errors of the method cancel in
// the differences, and a coarse tolerance serves: what Newton's method needs of a Jacobian are
// three or four digits. The last column needs no lane: H is quadratic in p, and so an extremal with
// s p(0) is the same, s times as fast, with s times the momenta. The derivative by s, at s = 1, is
//
//   dq(T)/dp(0) p(0) = T q'(T),     dp(T)/dp(0) p(0) = p(T) + T p'(T).
//
// It gives the column of the largest momentum. A tangent flow of Gauss gives more digits, at three
// to five times the cost.
#pragma once

#include <span>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

struct PackedTangent {
  SmallVector q1;  // q(T), to the coarse tolerance
  SmallMatrix j;   // dq(T)/dp(0)
  SmallMatrix k;   // dp(T)/dp(0)
};

// How many extremals fill a pack, of ends alone and with derivatives; 0 where the scene or the
// method has no packs.
int ends_of_a_pack(const Dynamics& dynamics);
int tangents_of_a_pack(const Dynamics& dynamics);

// q(T) of extremals from `problem.from` with these momenta, to the coarse tolerance; at most
// ends_of_a_pack() of them. False where one of them fails.
bool packed_ends(const BoundaryValueProblem& problem,
                 std::span<const SmallVector> p0,
                 std::span<SmallVector> q1);

// The same with derivatives, of at most tangents_of_a_pack(). Of a scene without drift or
// potential.
bool packed_tangents(const BoundaryValueProblem& problem,
                     std::span<const SmallVector> p0,
                     std::span<PackedTangent> tangents);

}  // namespace carnot::internal
