// The flat Martinet problem: a distribution with abnormal minimisers.
//
// M = diag(1, 1, 0), g = (y^2/2, 0, -1): z' = y^2 x'/2, and the length is that of the plane curve
// (x, y). Admissible velocities u1 (1, 0, y^2/2) + u2 (0, 1, 0), so with v = |u| constant
//
//   u1 = x' = p_x + p_z y^2/2,   u2 = y' = p_y,   y'' = -p_z y (p_x + p_z y^2/2):
//
// y is a Duffing oscillator and (x, y) an elastica of curvature -p_z y/v. From the origin, with
// p_z > 0, w = sqrt(p_z v), k^2 = (1 - p_x/v)/2 and Jacobi's elliptic functions of modulus k,
//
//   y = (p_y/w) sd(w t),   x = -v t + 2 (v/w) int_K^(K + w t) dn^2,
//
// which is shortest until y = 0 again, w t = 2 K(k), where it meets its mirror image. The lines
// y = 0 are abnormal extremals (the distribution is not contact there) and shortest all the same.
//
// Invariants: H, p_x, p_z.
// Source: Agrachev, Bonnard, Chyba & Kupka, ESAIM: COCV 2 (1997).
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Martinet {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, 0);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    return {0.5 * q[1] * q[1], 0, -1};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    Matrix<T, 3, 2> b;
    // clang-format off
    b << 1,                 0,
         0,                 1,
         0.5 * q[1] * q[1], 0;
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
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& q,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    return {0, p[2] * u[0] * q[1], 0};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "martinet";
    info.summary = "the flat Martinet problem: M = diag(1, 1, 0), z' = y^2 x'/2";
    info.reference = "Agrachev, Bonnard, Chyba & Kupka, ESAIM: COCV 2 (1997)";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length^3", 0}};
    info.symmetries.mirrors = {{1, -1, 1}, {-1, 1, -1}, {-1, -1, -1}};
    info.symmetries.cyclic = {0, 2};
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
