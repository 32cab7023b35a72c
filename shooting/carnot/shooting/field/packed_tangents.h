// Where extremals lead, and the derivatives of that by their momenta, several extremals at once.
//
// For derivatives an extremal takes n lanes of a pack: its own, and n - 1 with momenta that differ
// by a column of a basis D each. All lanes make the same steps, so that the errors of the method
// cancel in the differences, and a coarse tolerance serves: what Newton's method needs of a
// Jacobian are three or four digits. The inverse Jacobian of an extremal nearby is a good basis:
// its columns move the end alike, where a momentum itself may move it a million times as far along
// one direction as along another. The last column needs no lane: H is quadratic in p, and so an
// extremal with s p(0) is the same, s times as fast, with s times the momenta. The derivative by s,
// at s = 1, is
//
//   dq(T)/dp(0) p(0) = T q'(T),     dp(T)/dp(0) p(0) = p(T) + T p'(T),
//
// and gives the column that p(0) has most of. A tangent flow of Gauss gives more digits, at three
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
  SmallMatrix d;   // the columns of the basis, each as long as momenta were moved along it
  SmallMatrix j;   // dq(T)/dp(0) d
  SmallMatrix k;   // dp(T)/dp(0) d
};

// Whether the scene and the method have packs, and a pack has room for an extremal with its
// derivatives.
bool has_packs(const Dynamics& dynamics);

// The tolerances of flows: one for each extremal, and the least of a pack for all of it. Coarse
// ones do for Newton's method, fine ones are to be right to round-off.
inline constexpr double kCoarseFlow = 1e-6;
inline constexpr double kFineFlow = 1e-13;

// Ends of extremals from `problem.from` with these momenta.
std::vector<PackedEnd> packed_ends(const BoundaryValueProblem& problem,
                                   std::span<const SmallVector> p0,
                                   std::span<const double> tolerances);

// The same with derivatives, along a basis for each. Of a scene without drift or potential.
std::vector<PackedTangent> packed_tangents(const BoundaryValueProblem& problem,
                                           std::span<const SmallVector> p0,
                                           std::span<const SmallMatrix> bases,
                                           std::span<const double> tolerances);

}  // namespace carnot::internal
