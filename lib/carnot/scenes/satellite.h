// A satellite that turns about two of its body axes: a sub-Riemannian problem on SO(3).
//
// The attitude is R = Rz(psi) Ry(theta) Rx(phi), body to space. Body rates w, R' = R hat(w):
//
//   w_x = phi' - psi' sin theta,
//   w_y = psi' sin phi cos theta + theta' cos phi,
//   w_z = psi' cos phi cos theta - theta' sin phi = 0,
//
// cost (j1 w_x^2 + j2 w_y^2 + w_z^2)/2. Where cos theta = 0 psi and phi turn about the same axis:
// the chart is singular there. Elsewhere the admissible velocities are, with u = (w_x, w_y),
//
//   psi' = u2 sin phi/cos theta,   theta' = u2 cos phi,   phi' = u1 + u2 sin phi tan theta.
//
// The momenta m_i of the turns about the body axes obey m' = m x w with w = (m_x/j1, m_y/j2, 0).
// For j1 = j2 = j then m_z is constant and (m_x, m_y) turns at the rate m_z/j, so that
//
//   R(t) = R(0) exp(t hat(m(0))/j) Rz(-t m_z/j).
//
// Invariants: H, and R m, the momenta of the turns about the axes of space; p_psi is one of them.
// |m| follows. Source: Boscain & Rossi, SIAM J. Control Optim. 47 (2008), for j1 = j2.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Satellite {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  double j1 = 1;  // of the body's x axis, as a multiple of that of its z axis
  double j2 = 1;  // of its y axis

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& q) const {
    const Matrix<T, 3, 3> rates = body_rates(q);
    Matrix<T, 3, 3> weighted = rates;
    for (int j = 0; j < 3; ++j) {
      weighted(0, j) = j1 * rates(0, j);
      weighted(1, j) = j2 * rates(1, j);
    }
    return product(rates.transpose(), weighted);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    return body_rates(q).row(2);
  }

  // w = body_rates(q) q'.
  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> body_rates(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    Matrix<T, 3, 3> w;
    // clang-format off
    w << -sin(q[1]),            0,          1,
         sin(q[2]) * cos(q[1]), cos(q[2]),  0,
         cos(q[2]) * cos(q[1]), -sin(q[2]), 0;
    // clang-format on
    return w;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    const T psi_dot = sin(q[2]) / cos(q[1]);
    Matrix<T, 3, 2> b;
    // clang-format off
    b << 0, psi_dot,
         0, cos(q[2]),
         1, psi_dot * sin(q[1]);
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 3>& /*q*/) const {
    return {j1, j2};
  }

  // d/dq [p.B u - u'B'M B u/2].
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& q,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    const T c = cos(q[1]);
    const T s = sin(q[1]);
    const T along = (p[0] + p[2] * s) / c;
    const T by_theta = u[1] * sin(q[2]) * (p[2] + p[0] * s) / (c * c);
    const T by_phi = u[1] * (cos(q[2]) * along - sin(q[2]) * p[1]);
    return {0, by_theta, by_phi};
  }

  // cos theta.
  template <class T>
  [[nodiscard]] T chart(const Vector<T, 3>& q) const {
    using std::cos;
    return cos(q[1]);
  }

  static constexpr auto parameters() {
    using P = Parameter<Satellite>;
    return std::array{
        P{"j1", &Satellite::j1, "1", Range::positive(), "cost of turning about the body's x axis"},
        P{"j2", &Satellite::j2, "1", Range::positive(), "cost of turning about the body's y axis"}};
  }

  [[nodiscard]] SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    SceneInfo info;
    info.name = "satellite";
    info.summary = "a satellite that turns about two of its axes, in angles of yaw, pitch and roll";
    info.reference = "Boscain & Rossi, SIAM J. Control Optim. 47 (2008)";
    info.configuration = {{"psi", "rad", kTurn}, {"theta", "rad", kTurn}, {"phi", "rad", kTurn}};
    info.symmetries.mirrors = {{-1, 1, -1}, {-1, -1, 1}, {1, -1, -1}};
    info.symmetries.cyclic = {0};
    // The sphere of directions: where the body's x axis points, with its y axis as an arrow there.
    info.drawing = {
        .view = Drawing::View::kSpace,
        .body_in_space =
            [](const double* q) {
              const Attitude axes = attitude_of_angles(q[0], q[1], q[2]);
              constexpr double kArrow = 0.25;
              return arrow_on_sphere(axes[0], axes[1], kArrow);
            },
        .place = {{{{"X", "1", 0}, {"Y", "1", 0}, {"Z", "1", 0}}},
                  [](const double* q) { return attitude_of_angles(q[0], q[1], q[2])[0]; }},
        .sphere = 1,
        .path = "the body's x axis",
        .glyph = "its y axis"};
    info.extremes = {{"largest_pitch", "rad", [](const double* q) { return q[1]; }}};
    return info;
  }
};

}  // namespace carnot::scenes
