// Swinging up a pendulum with the least effort: a problem with drift.
//
// theta' = w, w' = -sin(theta) + u, cost u^2/2; theta = 0 hangs, theta = pi stands. Time is in
// units of sqrt(length/gravity). H = p_theta w - p_w sin(theta) + p_w^2/2 with u = p_w. Invariants:
// H; without control (p = 0) the energy w^2/2 - cos(theta). Reversal is (theta, w, p_theta, p_w) ->
// (theta, -w, -p_theta, p_w) here, not p -> -p. Source: Astrom & Furuta, Automatica 36 (2000),
// there by energy control.
#pragma once

#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Pendulum {
  static constexpr int kDof = 2;
  static constexpr int kControls = 1;

  template <class T>
  [[nodiscard]] Vector<T, 2> drift(const Vector<T, 2>& q) const {
    using std::sin;
    return {q[1], -sin(q[0])};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 2, 1> frame(const Vector<T, 2>& /*q*/) const {
    return {0, 1};
  }

  // d/dq [p.(f0 + F u) - u^2/2].
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_gradient(const Vector<T, 2>& q,
                                            const Vector<T, 2>& p,
                                            const Vector<T, 1>& /*u*/) const {
    using std::cos;
    return {-p[1] * cos(q[0]), p[0]};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "pendulum";
    info.summary = "swinging up a pendulum: theta' = w, w' = -sin(theta) + u, cost u^2/2";
    info.reference =
        "Astrom & Furuta, Swinging up a pendulum by energy control, Automatica 36 (2000)";
    info.configuration = {{"theta", "rad", 2 * std::numbers::pi}, {"w", "rad/time", 0}};
    info.symmetries.mirrors = {{-1, -1}};
    return info;
  }
};

}  // namespace carnot::scenes
