// The Grushin plane: the simplest frame that loses rank.
//
// x' = u1, y' = x u2, cost (u1^2 + u2^2)/2: a Riemannian metric but on the line x = 0, which is
// crossed horizontally only. H = (p_x^2 + x^2 p_y^2)/2; with w = p_y, x swings about 0,
//
//   x = x0 cos(w t) + p_x0 sin(w t)/w,      y = y0 + w (integral of x^2 from 0 to t).
//
// Invariants: H, p_y. Source: Agrachev, Barilari & Boscain, A Comprehensive Introduction to
// Sub-Riemannian Geometry (2019), ch. 9.
#pragma once

#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/stumpff.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Grushin {
  static constexpr int kDof = 2;
  static constexpr int kControls = 2;

  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> frame(const Vector<T, 2>& q) const {
    Matrix<T, 2, 2> f;
    // clang-format off
    f << 1, 0,
         0, q[0];
    // clang-format on
    return f;
  }

  // d/dq [p.F u - u.u/2].
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_gradient(const Vector<T, 2>& /*q*/,
                                            const Vector<T, 2>& p,
                                            const Vector<T, 2>& u) const {
    return {p[1] * u[1], 0};
  }

  // (q, p) at time t of the extremal with (q0, p0) at time 0; Stumpff functions keep the digits as
  // w -> 0. The integral of x^2 is x0^2 (t + sin(2 w t)/(2 w))/2 + x0 p_x0 sin^2(w t)/w^2 +
  // p_x0^2 (t - sin(2 w t)/(2 w))/(2 w^2).
  static Vector<double, 4> closed_form(const Vector<double, 2>& q0,
                                       const Vector<double, 2>& p0,
                                       double t) {
    const double turn = p0[1] * t;
    const double s = t * stumpff<1>(turn * turn);  // sin(w t) / w
    const double square = q0[0] * q0[0] * 0.5 * t * (1 + stumpff<1>(4 * turn * turn)) +
                          q0[0] * p0[0] * s * s +
                          p0[0] * p0[0] * 2 * t * t * t * stumpff<3>(4 * turn * turn);
    return {q0[0] * std::cos(turn) + p0[0] * s,
            q0[1] + p0[1] * square,
            p0[0] * std::cos(turn) - p0[1] * p0[1] * q0[0] * s,
            p0[1]};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "grushin";
    info.summary = "the Grushin plane: x' = u1, y' = x u2";
    info.reference =
        "Agrachev, Barilari & Boscain, A Comprehensive Introduction to Sub-Riemannian Geometry "
        "(2019), ch. 9";
    info.configuration = {{"x", "length", 0}, {"y", "length^2", 0}};
    info.symmetries.mirrors = {{-1, 1}, {1, -1}};
    info.symmetries.cyclic = {1};
    info.drawing = {.view = Drawing::View::kPlane, .axes = {0, 1, 1}};
    return info;
  }
};

}  // namespace carnot::scenes
