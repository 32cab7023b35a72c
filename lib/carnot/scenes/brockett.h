// Brockett's nonholonomic integrator: x' = u1, y' = u2, z' = x u2 - y u1, cost (u1^2 + u2^2)/2.
//
// The Heisenberg group with z twice the area swept in the plane. With w = 2 p_z the controls turn,
// u1 + i u2 = (u1 + i u2)(0) exp(i w t), so the plane curve is an arc of a circle:
//
//   c = x + i y = c0 + u0 (exp(i w t) - 1)/(i w),
//   z = z0 + Im(conj(c0) (c - c0)) + |u0|^2 (w t - sin w t)/w^2.
//
// Invariants: H, p_z, x p_y - y p_x. Source: Brockett, Control theory and singular Riemannian
// geometry, in New Directions in Applied Mathematics (1982).
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/stumpff.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Brockett {
  static constexpr int kDof = 3;
  static constexpr int kControls = 2;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    Matrix<T, 3, 2> f;
    // clang-format off
    f << 1,     0,
         0,     1,
         -q[1], q[0];
    // clang-format on
    return f;
  }

  // d/dq [p.F u - u.u/2].
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& /*q*/,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    return {p[2] * u[1], -p[2] * u[0], 0};
  }

  // (q, p) at time t of the extremal with (q0, p0) at time 0; Stumpff functions keep the digits as
  // w -> 0.
  static Vector<double, 6> closed_form(const Vector<double, 3>& q0,
                                       const Vector<double, 3>& p0,
                                       double t) {
    const double u1 = p0[0] - q0[1] * p0[2];
    const double u2 = p0[1] + q0[0] * p0[2];
    const double turn = 2 * p0[2] * t;
    const double s = t * stumpff<1>(turn * turn);         // sin(w t) / w
    const double c = t * turn * stumpff<2>(turn * turn);  // (1 - cos(w t)) / w
    const double dx = u1 * s - u2 * c;
    const double dy = u2 * s + u1 * c;
    const double area = (u1 * u1 + u2 * u2) * t * t * turn * stumpff<3>(turn * turn);
    Vector<double, 6> z;
    // p_x' = -p_z u2 = -p_z y' and p_y' = p_z u1 = p_z x'.
    z << q0[0] + dx, q0[1] + dy, q0[2] + q0[0] * dy - q0[1] * dx + area,  //
        p0[0] - p0[2] * dy, p0[1] + p0[2] * dx, p0[2];
    return z;
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "brockett";
    info.summary = "Brockett's integrator: x' = u1, y' = u2, z' = x u2 - y u1";
    info.reference = "Brockett, in New Directions in Applied Mathematics, Springer (1982)";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length^2", 0}};
    info.symmetries.mirrors = {{-1, -1, 1}, {1, -1, -1}};
    info.symmetries.cyclic = {2};
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
