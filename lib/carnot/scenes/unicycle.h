// A wheel, or knife edge, in the plane: the sub-Riemannian problem on SE(2).
//
// At (x, y) with heading theta, no slip sideways: x' sin theta - y' cos theta = 0. Cost
// (x'^2 + y'^2 + beta^2 theta'^2)/2, beta a length. Admissible: x' = u1 cos, y' = u1 sin,
// theta' = u2. Invariants: H, p_x, p_y, x p_y - y p_x + p_theta.
// Source: Moiseev & Sachkov, ESAIM: COCV 16 (2010).
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Unicycle {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;

  double beta = 1;  // turning by one radian costs as much as driving this far

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, beta * beta);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    return {sin(q[2]), -cos(q[2]), 0};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    using std::cos, std::sin;
    Matrix<T, 3, 2> b;
    // clang-format off
    b << cos(q[2]), 0,
         sin(q[2]), 0,
         0,         1;
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 3>& /*q*/) const {
    return {1, beta * beta};
  }

  // d/dq [p.B u - u'B'M B u/2].
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& q,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    return {0, 0, u[0] * (p[1] * cos(q[2]) - p[0] * sin(q[2]))};
  }

  static constexpr auto parameters() {
    using P = Parameter<Unicycle>;
    return std::array{P{"beta",
                        &Unicycle::beta,
                        "length",
                        Range::positive(),
                        "turning by one radian costs as much as driving this far"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "unicycle";
    info.summary = "a wheel in the plane: the sub-Riemannian problem on SE(2)";
    info.reference = "Moiseev & Sachkov, ESAIM: COCV 16 (2010)";
    info.configuration = {
        {"x", "length", 0}, {"y", "length", 0}, {"theta", "rad", 2 * std::numbers::pi}};
    info.symmetries = {.mirrors = {{1, -1, -1}}, .x = 0, .y = 1, .angles = {2}};
    info.drawing = {.view = Drawing::View::kPlane, .body = [r = 0.1 * beta](const double* q) {
                      return std::vector<Polyline>{wheel({q[0], q[1]}, q[2], r)};
                    }};
    return info;
  }
};

}  // namespace carnot::scenes
