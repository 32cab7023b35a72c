// The Heisenberg problem as the paper writes it (McLachlan et al. 2013, section 6).
//
// M = I, g = (-y, x, 1): z' = y x' - x y'. Admissible velocities u1 (1, 0, y) + u2 (0, 1, -x).
// The z' of the constraint costs: this is not the standard Heisenberg group (heisenberg_group.h).
// Invariants: H, p_z, x p_y - y p_x.
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Heisenberg {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    return {-q[1], q[0], 1};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    Matrix<T, 3, 2> b;
    // clang-format off
    b << 1,    0,
         0,    1,
         q[1], -q[0];
    // clang-format on
    return b;
  }

  // d/dq [p.v - v.v/2] with v = (u1, u2, u1 y - u2 x).
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& q,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    const T slope = p[2] - (u[0] * q[1] - u[1] * q[0]);
    return {-slope * u[1], slope * u[0], 0};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "heisenberg";
    info.summary = "the paper's Heisenberg problem: M = I, g = (-y, x, 1)";
    info.reference = "McLachlan, Modin, Verdier & Wilkins, SIAM J. Sci. Comput. 35 (2013), sec. 6";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length", 0}};
    info.symmetries.mirrors = {{-1, -1, 1}, {1, -1, -1}};
    info.symmetries.cyclic = {2};
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
