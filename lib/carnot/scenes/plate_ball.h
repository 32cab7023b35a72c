// A unit ball rolled on a table by a plate, without slip or spin: the plate-ball problem.
//
// Centre above (x, y), attitude R = Rz(psi) Ry(theta) Rx(phi), body to space. The rates in space,
//
//   w_x = -theta' sin psi + phi' cos psi cos theta,
//   w_y =  theta' cos psi + phi' sin psi cos theta,   w_z = psi' - phi' sin theta,
//
// obey x' = w_y, y' = -w_x (the point of contact rests) and w_z = 0 (no spin). The cost is that of
// the track, (x'^2 + y'^2)/2. With u = (x', y') the admissible velocities are
//
//   psi' = s tan theta,   theta' = u1 cos psi + u2 sin psi,   phi' = s/cos theta,
//   s = u1 sin psi - u2 cos psi;
//
// where cos theta = 0 psi and phi turn about the same axis: the chart is singular there.
// u turns at the rate -p_psi, and p_psi' = p_x y' - p_y x': the curvature of the track is linear
// along it, so tracks are elasticae. For p_x = p_y = 0 they are circles and, with the momenta s_i
// of the turns about the axes of space, R(t) = Rz(-t p_psi) exp(t hat(s(0))) R(0).
//
// Invariants: H, p_x, p_y, x p_y - y p_x + p_psi, and the momenta of the turns about the three axes
// of the body; p_phi is one of them. Source: Jurdjevic, Arch. Rational Mech. Anal. 124 (1993).
#pragma once

#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct PlateBall {
  static constexpr int kDof = 5;
  static constexpr int kMultipliers = 3;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 5, 5> mass(const Vector<T, 5>& /*q*/) const {
    return diagonal<T>(1, 1, 0, 0, 0);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 5> constraints(const Vector<T, 5>& q) const {
    using std::cos, std::sin;
    const T c = cos(q[3]);
    Matrix<T, 3, 5> g;
    // clang-format off
    g << 0,  1, 0, -sin(q[2]), cos(q[2]) * c,
         -1, 0, 0, cos(q[2]),  sin(q[2]) * c,
         0,  0, 1, 0,          -sin(q[3]);
    // clang-format on
    return g;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 5, 2> frame(const Vector<T, 5>& q) const {
    using std::cos, std::sin;
    const T phi_dot1 = sin(q[2]) / cos(q[3]);
    const T phi_dot2 = -cos(q[2]) / cos(q[3]);
    Matrix<T, 5, 2> b;
    // clang-format off
    b << 1,                    0,
         0,                    1,
         phi_dot1 * sin(q[3]), phi_dot2 * sin(q[3]),
         cos(q[2]),            sin(q[2]),
         phi_dot1,             phi_dot2;
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 5>& /*q*/) const {
    return {1, 1};
  }

  // d/dq [p.B u - u'B'M B u/2].
  template <class T>
  [[nodiscard]] Vector<T, 5> frame_gradient(const Vector<T, 5>& q,
                                            const Vector<T, 5>& p,
                                            const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    const T c = cos(q[3]);
    const T s = sin(q[3]);
    const T across = u[0] * sin(q[2]) - u[1] * cos(q[2]);
    const T along = u[0] * cos(q[2]) + u[1] * sin(q[2]);
    Vector<T, 5> gradient;
    gradient[0] = gradient[1] = gradient[4] = 0;
    gradient[2] = along * (p[2] * s + p[4]) / c - across * p[3];
    gradient[3] = across * (p[2] + p[4] * s) / (c * c);
    return gradient;
  }

  // cos theta.
  template <class T>
  [[nodiscard]] T chart(const Vector<T, 5>& q) const {
    using std::cos;
    return cos(q[3]);
  }

  [[nodiscard]] SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    SceneInfo info;
    info.name = "plate-ball";
    info.summary = "a unit ball that rolls on a table without slip or spin";
    info.reference = "Jurdjevic, Arch. Rational Mech. Anal. 124 (1993)";
    info.configuration = {{"x", "radius", 0},
                          {"y", "radius", 0},
                          {"psi", "rad", kTurn},
                          {"theta", "rad", kTurn},
                          {"phi", "rad", kTurn}};
    info.symmetries = {.mirrors = {{1, -1, -1, 1, -1}, {-1, -1, 1, -1, -1}, {-1, 1, -1, -1, 1}},
                       .x = 0,
                       .y = 1,
                       .angles = {2}};
    info.drawing = {.view = Drawing::View::kPlane,
                    .body =
                        [](const double* q) {
                          constexpr double kShown = 0.15;  // of the radius
                          return globe({q[0], q[1]}, kShown, attitude_of_angles(q[2], q[3], q[4]));
                        },
                    .glyph = "ball from above, drawn small"};
    return info;
  }
};

}  // namespace carnot::scenes
