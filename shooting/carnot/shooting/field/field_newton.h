// Extremals to given ends by Newton's method, from momenta that are nearly right.
//
// Many are solved side by side where the scene has packs (packed_tangents.h). A coarse flow with
// the inverse Jacobian of a neighbour, coarse tangents, and finer flows with the last inverse
// Jacobian follow each other. Without packs tangent flows do it, one by one.
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
  // p0 where it begins, or none where there is no hope; then all but windings and origin, if found.
  FieldPoint point;
  bool rough = false;  // six digits are enough
  bool found = false;
};

class FieldNewton {
 public:
  // Keeps a reference.
  explicit FieldNewton(const BoundaryValueProblem& problem);

  // All of them that have a p0; `flows` counts tangent flows, one for each extremal of a pack.
  void solve(std::span<FieldAttempt> attempts, long& flows) const;
  // One by tangent flows, with so many times the usual steps. False where there is none.
  bool solve(const std::vector<double>& target,
             FieldPoint& point,
             long& flows,
             int factor = 1) const;
  // Takes each point.p0, which is nearly right, to round-off with its point.inverse, by flows of
  // packs; those are found that it succeeds with.
  void polish(std::span<FieldAttempt> attempts) const;
  // q(T) of a flow of so many times the usual steps; empty where it fails.
  [[nodiscard]] std::vector<double> end(const SmallVector& p0, int factor) const;

 private:
  // Steps of the method that are enough for most momenta of this size.
  [[nodiscard]] long steps_for(const SmallVector& p0) const;
  // Flows from p0; z is the end. False where that fails.
  bool flow(const SmallVector& p0, int factor, std::vector<double>& z) const;
  // Takes each p0 nearer to the target by a flow of a pack, with the inverse Jacobian of a
  // neighbour. Returns those that it succeeds with.
  using Near = std::vector<std::size_t>;
  Near approach_packed(std::span<FieldAttempt> attempts) const;
  void solve_packed(std::span<FieldAttempt> attempts, long& flows) const;
  // A step of Newton's method, from p0 with these tangents. `last` is the error before the step.
  enum class Step {
    kOn,    // another one is needed
    kNear,  // the point is known to six digits
    kLost,  // there is nothing to hope for
  };
  [[nodiscard]] Step improve(const PackedTangent& tangent,
                             FieldAttempt& attempt,
                             double& last) const;
  // Takes p0 nearer to `target` by flows alone, with the inverse Jacobian of a neighbour.
  void approach(const FieldAttempt& attempt, SmallVector& p0) const;
  bool set_action(FieldPoint& point) const;

  const BoundaryValueProblem& problem_;
  int n_;
};

}  // namespace carnot::internal
