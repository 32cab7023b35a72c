// Extremals to given ends by Newton's method, from momenta that are nearly right.
//
// Many are solved side by side where the scene has packs (packed_tangents.h): a coarse flow with
// the inverse Jacobian of a neighbour and coarse tangents bring an end within 1e-3, and exact flows
// with the last inverse Jacobian take it to round-off. Where that fails, and without packs, tangent
// flows do it, one by one.
#pragma once

#include <span>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/field/field_store.h"
#include "carnot/shooting/field/packed_tangents.h"

namespace carnot::internal {

// An extremal that is looked for.
struct FieldAttempt {
  std::vector<double> target;
  SmallMatrix inverse;  // of a neighbour's Jacobian
  FieldPoint point;     // p0 where it begins; then all but its windings and origin, where found
  bool found = false;
};

class FieldNewton {
 public:
  // Keeps a reference.
  explicit FieldNewton(const BoundaryValueProblem& problem);

  // All of them; `flows` counts tangent flows, one for each extremal of a pack. Where extremals
  // flow in packs, what those do not find is tried one by one only where care is thorough.
  enum class Care { kQuick, kThorough };
  void solve(std::span<FieldAttempt> attempts, Care care, long& flows) const;
  // One by tangent flows, with so many times the usual steps. False where there is none.
  bool solve(const std::vector<double>& target,
             FieldPoint& point,
             long& flows,
             int factor = 1) const;
  // q(T) of a flow of so many times the usual steps; empty where it fails.
  [[nodiscard]] std::vector<double> end(const SmallVector& p0, int factor) const;

 private:
  // Steps of the method that are enough for most momenta of this size.
  [[nodiscard]] long steps_for(const SmallVector& p0) const;
  // Flows from p0; z is the end. False where that fails.
  bool flow(const SmallVector& p0, int factor, std::vector<double>& z) const;
  // Takes each p0 nearer to the target of its attempt by a flow of a pack.
  void approach_packed(std::span<const FieldAttempt> attempts, std::span<SmallVector> p0) const;
  void solve_packed(std::span<FieldAttempt> attempts, long& flows) const;
  // A step of Newton's method, from p0 with these tangents. True where another one is needed; else
  // the attempt is found, or there is nothing to hope for. `last` is the error before the step.
  bool improve(const PackedTangent& tangent,
               FieldAttempt& attempt,
               SmallVector& p0,
               double& last) const;
  // Takes point.p0 to round-off with point.inverse, which is that of an end within `near`.
  bool polish(const std::vector<double>& target, double near, FieldPoint& point) const;
  // Takes p0 nearer to `target` by flows alone, with the inverse Jacobian of a neighbour.
  void approach(const FieldAttempt& attempt, SmallVector& p0) const;
  bool set_action(FieldPoint& point) const;

  const BoundaryValueProblem& problem_;
  int n_;
};

}  // namespace carnot::internal
