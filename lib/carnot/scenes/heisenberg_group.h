// The Heisenberg group with its Carnot-Caratheodory metric.
//
// M = diag(1, 1, 0), g = (y/2, -x/2, 1): z' = (x y' - y x')/2, the area swept in the plane, and the
// length is that of the plane curve (x, y). M is singular, M > 0 on ker G. Extremals project to
// arcs of circles of curvature p_z: with w = p_z and u = (u1, u2)(0) at the origin,
//
//   x + i y = (u1 + i u2) (exp(i w t) - 1) / (i w),   z = |u|^2 (w t - sin w t) / (2 w^2).
//
// Invariants: H, p_z, x p_y - y p_x. Source: Montgomery, A Tour of Subriemannian Geometries (2002).
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/stumpff.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct HeisenbergGroup {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, 0);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    return {0.5 * q[1], -0.5 * q[0], 1};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    Matrix<T, 3, 2> b;
    // clang-format off
    b << 1,           0,
         0,           1,
         -0.5 * q[1], 0.5 * q[0];
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 3>& /*q*/) const {
    return {1, 1};
  }

  // d/dq [p.B u - u.u/2].
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& /*q*/,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    const T half = 0.5 * p[2];
    return {half * u[1], -half * u[0], 0};
  }

  // The extremal from the origin with momentum p at time t, in closed form; Stumpff functions keep
  // its digits as w -> 0.
  static Vector<double, 3> closed_form(const Vector<double, 3>& p, double t) {
    const double speed2 = p[0] * p[0] + p[1] * p[1];
    const double turn = p[2] * t;
    const double s = t * stumpff<1>(turn * turn);         // sin(w t) / w
    const double c = t * turn * stumpff<2>(turn * turn);  // (1 - cos(w t)) / w
    const double z = 0.5 * speed2 * t * t * turn * stumpff<3>(turn * turn);
    return {p[0] * s - p[1] * c, p[1] * s + p[0] * c, z};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "heisenberg-group";
    info.summary = "the Heisenberg group: M = diag(1, 1, 0), z' = (x y' - y x')/2";
    info.reference = "Montgomery, A Tour of Subriemannian Geometries (2002), ch. 1";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length^2", 0}};
    info.symmetries.mirrors = {{-1, -1, 1}, {1, -1, -1}};
    info.symmetries.cyclic = {2};
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
