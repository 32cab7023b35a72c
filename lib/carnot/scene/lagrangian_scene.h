// What the author of a Lagrangian scene writes.
//
// Required: the sizes kDof (n) and kMultipliers (k), and L(t, q, v) as a template of the scalar;
// for k > 0 the constraints g(q, v), which need not be linear in v. Optional: kTimeDependent, true
// where L depends on t, a first guess of v for Newton's method, and what scene_info.h lists.
#pragma once

#include <concepts>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/velocity_constrained_scene.h"

namespace carnot {

template <class S>
concept HasLagrangian = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.lagrangian(0.0, q, q) } -> std::convertible_to<double>;
};

// g(q, v), length k, zero on the admissible velocities.
template <class S>
concept HasVelocityConstraint = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.constraint(q, q) } -> std::convertible_to<Vector<double, S::kMultipliers>>;
};

template <class S>
concept LagrangianScene = HasLagrangian<S> && !VelocityConstrainedScene<S> &&
                          (S::kMultipliers == 0 || HasVelocityConstraint<S>);

// velocity_guess(t, q, p): near the v that belongs to p, where v = 0 is no good start.
template <class S>
concept HasVelocityGuess = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.velocity_guess(0.0, q, q) } -> std::convertible_to<Vector<double, S::kDof>>;
};

}  // namespace carnot
