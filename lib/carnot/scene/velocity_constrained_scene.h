// What the author of a scene with velocity constraints writes.
//
// Required: the sizes kDof (n) and kMultipliers (k), the mass matrix M(q) and the rows of G(q), as
// templates of the scalar. Optional: a potential V(q), a frame B(q) of the admissible velocities,
// derivatives by hand for the hot path, chart(q) (chart.h), and what scene_info.h lists.
#pragma once

#include <concepts>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

// Needs kDof, kMultipliers, mass(q) (n x n, symmetric), constraints(q) (k x n), all templates.
template <class S>
concept VelocityConstrainedScene = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.mass(q) } -> std::convertible_to<Matrix<double, S::kDof, S::kDof>>;
  { scene.constraints(q) } -> std::convertible_to<Matrix<double, S::kMultipliers, S::kDof>>;
};

// A scene may say `kConstantMass = true`: M does not depend on q, and nobody asks for its
// derivatives.
template <class S>
concept HasConstantMass = S::kConstantMass;

template <class S>
concept HasPotential = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.potential(q) } -> std::convertible_to<double>;
};

// B(q), n x (n - k), columns that span ker G(q).
template <class S>
concept HasFrame = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.frame(q) } -> std::convertible_to<Matrix<double, S::kDof, S::kDof - S::kMultipliers>>;
};

// d/dq [p.B(q) u - u'(B'M B) u/2 + V(q)] at fixed p, u: the derivative by hand.
template <class S>
concept HasFrameGradient = HasFrame<S> &&
    requires(const S& scene,
             const Vector<double, S::kDof>& q,
             const Vector<double, S::kDof - S::kMultipliers>& u) {
  { scene.frame_gradient(q, q, u) } -> std::convertible_to<Vector<double, S::kDof>>;
};

// B'M B, (n - k) x (n - k), by hand.
template <class S>
concept HasFrameMass = HasFrame<S> && requires(const S& scene, const Vector<double, S::kDof>& q) {
  {
    scene.frame_mass(q)
    } -> std::convertible_to<Matrix<double, S::kDof - S::kMultipliers, S::kDof - S::kMultipliers>>;
};

// The same where B'M B is diagonal, of the columns of B that are orthogonal under M: its diagonal.
template <class S>
concept HasOrthogonalFrame = HasFrame<S> &&
    requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.frame_masses(q) } -> std::convertible_to<Vector<double, S::kDof - S::kMultipliers>>;
};

// h(q) = 0, kHolonomic (l) of them, besides the velocity constraints.
template <class S>
concept HasHolonomic = requires(const S& scene, const Vector<double, S::kDof>& q) {
  { scene.holonomic(q) } -> std::convertible_to<Vector<double, S::kHolonomic>>;
};

// The scene says that its formulas also mean something where h(q) is not zero, and that they make
// the whole space a product: a metric without potential in which h is a function of coordinates
// that move like a free particle, apart from the others. So a motion that starts with h = 0 and Dh
// q' = 0 keeps both without forces, a geodesic of the whole space between points of the manifold
// stays on it and is conjugate where it is on the manifold, and a method that keeps quadratic
// invariants keeps a quadratic h to round-off.
template <class S>
concept IsProduct = HasHolonomic<S> && S::kProduct;

}  // namespace carnot
