// A unit mass on a rigid massless rod, in space: no velocity constraint, one holonomic one.
//
//   h = x^2 + y^2 + z^2 - length^2,    V = gravity z,    M = I.
//
// Invariants: H, x p_y - y p_x.
#pragma once

#include <array>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct SphericalPendulum {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 0;
  static constexpr bool kConstantMass = true;
  static constexpr int kHolonomic = 1;

  double length = 1;
  double gravity = 1;  // acceleration along -z

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 0, 3> constraints(const Vector<T, 3>& /*q*/) const {
    return {};
  }

  template <class T>
  [[nodiscard]] Vector<T, 1> holonomic(const Vector<T, 3>& q) const {
    return Vector<T, 1>(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] - length * length);
  }

  template <class T>
  [[nodiscard]] T potential(const Vector<T, 3>& q) const {
    return gravity * q[2];
  }

  static constexpr auto parameters() {
    using P = Parameter<SphericalPendulum>;
    return std::array{
        P{"length", &SphericalPendulum::length, "length", Range::positive(), "length of the rod"},
        P{"gravity",
          &SphericalPendulum::gravity,
          "length/time^2",
          Range::non_negative(),
          "acceleration along -z"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "spherical-pendulum";
    info.summary = "a mass on a rigid rod in space, with gravity";
    info.reference = "McLachlan, Modin, Verdier & Wilkins, SIAM J. Sci. Comput. 35 (2013), sec. 4";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length", 0}};
    info.symmetries.mirrors = {{-1, 1, 1}, {1, -1, 1}};
    info.drawing = {.view = Drawing::View::kSpace,
                    .body_in_space =
                        [](const double* q) {
                          return std::vector<SpaceLine>{{{{0, 0, 0}, {q[0], q[1], q[2]}}}};
                        },
                    .sphere = length,
                    .glyph = "rod"};
    return info;
  }
};

}  // namespace carnot::scenes
