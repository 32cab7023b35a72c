// What the author of an optimal-control scene writes.
//
// Minimise the integral of l(t, q, u) over paths with q' = f(t, q, u), u in R^c. Required: the
// sizes kDof (n) and kControls (c) and, as templates of the scalar, one of
//
//   linear   frame(q) -> F, n x c; where there are any, drift(q) -> f0, control_weight(q) -> R
//            (c x c, positive definite), state_cost(q) -> l0. Then f = f0 + F u and
//            l = l0 + u'R u/2, with R = I unless given: u is found without iteration.
//   general  dynamics(t, q, u) -> f and running_cost(t, q, u) -> l: u is found by Newton's method.
//
// A scene that writes both is taken as linear. Optional: `kTimeDependent = true` where f or l
// depends on t, initial_controls(t, q, p) -> u (the branch that a cold start takes), chart(q), the
// derivative of H by hand, and what scene_info.h lists.
#pragma once

#include <concepts>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

// F(q), the part of f linear in u.
template <class S>
concept HasLinearControls = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.frame(q) } -> std::convertible_to<Matrix<double, S::kDof, S::kControls>>;
};

template <class S>
concept HasGeneralControls = requires(const S& scene,
                                      const Vector<double, S::kDof>& q,
                                      const Vector<double, S::kControls>& u) {
  { scene.dynamics(0.0, q, u) } -> std::convertible_to<Vector<double, S::kDof>>;
  { scene.running_cost(0.0, q, u) } -> std::convertible_to<double>;
};

template <class S>
concept OptimalControlScene = HasLinearControls<S> || HasGeneralControls<S>;

// f0(q), the velocity at u = 0.
template <class S>
concept HasDrift = HasLinearControls<S> &&
    requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.drift(q) } -> std::convertible_to<Vector<double, S::kDof>>;
};

// R(q), symmetric and positive definite.
template <class S>
concept HasControlWeight = HasLinearControls<S> &&
    requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.control_weight(q) } -> std::convertible_to<Matrix<double, S::kControls, S::kControls>>;
};

// l0(q), the cost at u = 0.
template <class S>
concept HasStateCost = HasLinearControls<S> &&
    requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.state_cost(q) } -> std::convertible_to<double>;
};

// H_q = d/dq [p.f - l] at fixed p, u: the derivative by hand, of a linear scene.
template <class S>
concept HasControlGradient = HasLinearControls<S> &&
    requires(const S& scene,
             const Vector<double, S::kDof>& q,
             const Vector<double, S::kControls>& u) {
  { scene.frame_gradient(q, q, u) } -> std::convertible_to<Vector<double, S::kDof>>;
};

// Where Newton's method for u starts without a warm start. Needed where H_u = 0 has several
// branches, or H_uu is singular at u = 0.
template <class S>
concept HasInitialControls = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.initial_controls(0.0, q, q) } -> std::convertible_to<Vector<double, S::kControls>>;
};

}  // namespace carnot
