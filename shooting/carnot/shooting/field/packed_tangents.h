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
//
// All lanes of a pack make the same steps and fail together. So momenta of one size share a pack,
// and where a pack fails it is tried again without the lane that it fails in.
#pragma once

#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {

struct PackedEnd {
  bool reached = false;
  SmallVector q1;  // q(T)
  SmallVector p1;  // p(T)
};

struct PackedTangent {
  bool reached = false;
  SmallVector q1;  // q(T), to the coarse tolerance
  SmallVector p1;  // p(T), the same
  SmallMatrix j;   // dq(T)/dp(0)
  SmallMatrix k;   // dp(T)/dp(0)
};

// Whether the scene and the method have packs, and a pack has room for an extremal with its
// derivatives.
bool has_packs(const Dynamics& dynamics);

// Of a flow for Newton's method, and of one that is to be right to round-off.
inline constexpr double kCoarseFlow = 1e-6;
inline constexpr double kFineFlow = 1e-12;

// Ends of extremals from `problem.from` with these momenta, by flows with local errors of about
// `tolerance`.
std::vector<PackedEnd> packed_ends(const BoundaryValueProblem& problem,
                                   std::span<const SmallVector> p0,
                                   double tolerance);

// The same with derivatives, to the coarse tolerance. Of a scene without drift or potential.
std::vector<PackedTangent> packed_tangents(const BoundaryValueProblem& problem,
                                           std::span<const SmallVector> p0);

}  // namespace carnot::internal
