// The Engel group: the nilpotent model of a car with a trailer, and the simplest of step 3.
//
// M = diag(1, 1, 0, 0), admissible velocities u1 X1 + u2 X2 with
//
//   X1 = (1, 0, -x2/2, 0),   X2 = (0, 1, x1/2, (x1^2 + x2^2)/2),
//   [X1, X2] = X3 = (0, 0, 1, x1),   [X1, X3] = X4 = (0, 0, 0, 1),   all others zero.
//
// With h_i = p.X_i, the momenta in this frame: u1 = h1, u2 = h2 and
//
//   h1' = -h2 h3,   h2' = h1 h3,   h3' = h1 h4,   h4' = 0.
//
// The angle of (h1, h2) is that of a pendulum, and (x1, x2) is an elastica: its curvature h3/|u|,
// h3 = p3 + x1 p4, is linear in x1.
//
// Invariants: H, and the momenta in the right-invariant frame, which the group moves along: p3, p4,
// p1 + x2 p3/2 + (x3 + x1 x2/2) p4 and p2 - x1 p3/2 + x2^2 p4/2. The Casimir functions h4 and
// h3^2/2 - h2 h4 are functions of these.
// Source: Ardentov & Sachkov, Sbornik: Mathematics 202 (2011).
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Engel {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 2;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 4, 4> mass(const Vector<T, 4>& /*q*/) const {
    return diagonal<T>(1, 1, 0, 0);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 2, 4> constraints(const Vector<T, 4>& q) const {
    Matrix<T, 2, 4> g;
    // clang-format off
    g << 0.5 * q[1], -0.5 * q[0],     1, 0,
         0,          -half_square(q), 0, 1;
    // clang-format on
    return g;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 4, 2> frame(const Vector<T, 4>& q) const {
    Matrix<T, 4, 2> b;
    // clang-format off
    b << 1,           0,
         0,           1,
         -0.5 * q[1], 0.5 * q[0],
         0,           half_square(q);
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 4>& /*q*/) const {
    return {1, 1};
  }

  // d/dq [p.B u - u.u/2].
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& q,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 2>& u) const {
    const T half = 0.5 * p[2];
    return {u[1] * (half + q[0] * p[3]), u[1] * q[1] * p[3] - u[0] * half, 0, 0};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "engel";
    info.summary = "the Engel group: the nilpotent model of a car with a trailer";
    info.reference = "Ardentov & Sachkov, Sbornik: Mathematics 202 (2011)";
    info.configuration = {
        {"x1", "length", 0}, {"x2", "length", 0}, {"x3", "length^2", 0}, {"x4", "length^3", 0}};
    info.symmetries.mirrors = {{-1, 1, -1, 1}, {1, -1, -1, -1}, {-1, -1, 1, -1}};
    info.symmetries.cyclic = {2, 3};
    info.drawing.view = Drawing::View::kPlane;
    return info;
  }

 private:
  // (x1^2 + x2^2)/2.
  template <class T>
  static T half_square(const Vector<T, 4>& q) {
    return 0.5 * (q[0] * q[0] + q[1] * q[1]);
  }
};

}  // namespace carnot::scenes
