// A boat in a current: nonlinear in its controls, with drift (Zermelo's navigation problem).
//
// Thrust u1 along the heading u2, in water that flows along x with the speed shear y:
//
//   x' = u1 cos(u2) + shear y,   y' = u1 sin(u2),   cost u1^2/2 + u1^4/4.
//
// H_u = 0 has a pair of regular branches, the heading along p or against it with u1 < 0:
//
//   u1 (1 + u1^2) = |p|,  u2 = atan2(p_y, p_x),      and the same with (-u1, u2 + pi),
//
// both with the same velocity and both a maximum of H; and one of no use, u1 = 0 with u2 across p,
// a saddle. At p = 0 the heading is arbitrary and H_uu singular.
//
// Invariants: H, p_x, and p_y + shear p_x t is constant. So y = (H - h(|p|))/(shear p_x) is known
// in closed form, h = u1^2/2 + 3 u1^4/4 at u1(|p|).
// Source: Bryson & Ho, Applied Optimal Control (1975), ch. 2 (there in least time).
#pragma once

#include <array>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Boat {
  static constexpr int kDof = 2;
  static constexpr int kControls = 2;

  double shear = 0.5;  // of the current, its speed per distance from the x axis

  template <class T>
  [[nodiscard]] Vector<T, 2> dynamics(const T& /*t*/,
                                      const Vector<T, 2>& q,
                                      const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    return {u[0] * cos(u[1]) + shear * q[1], u[0] * sin(u[1])};
  }

  template <class T>
  [[nodiscard]] T running_cost(const T& /*t*/,
                               const Vector<T, 2>& /*q*/,
                               const Vector<T, 2>& u) const {
    const T square = u[0] * u[0];
    return 0.5 * square + 0.25 * square * square;
  }

  // Heading along p, thrust from above: u + u^3 - |p| is convex and not negative there, so that
  // Newton's method goes down to its root.
  template <class T>
  [[nodiscard]] Vector<T, 2> initial_controls(const T& /*t*/,
                                              const Vector<T, 2>& /*q*/,
                                              const Vector<T, 2>& p) const {
    using std::atan2, std::cbrt, std::hypot;
    const T size = hypot(p[0], p[1]);
    return {size < 1 ? size : T(cbrt(size)), atan2(p[1], p[0])};
  }

  static constexpr auto parameters() {
    using P = Parameter<Boat>;
    return std::array{P{"shear",
                        &Boat::shear,
                        "1/time",
                        Range{},
                        "speed of the current per distance from the x axis"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "boat";
    info.summary = "a boat in a sheared current, nonlinear in thrust and heading";
    info.reference = "Bryson & Ho, Applied Optimal Control (1975), ch. 2";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}};
    info.symmetries.mirrors = {{-1, -1}};
    info.drawing = {.view = Drawing::View::kPlane, .axes = {0, 1, 1}};
    return info;
  }
};

}  // namespace carnot::scenes
