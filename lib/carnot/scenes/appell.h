// Appell's constraint, not linear in the velocities: x'^2 + y'^2 = c^2 z'^2.
//
// A unit mass, L = |v|^2/2 - gravity z - stiffness (x^2 + y^2)/2, moves along the rays of the cone
// g = x'^2 + y'^2 - c^2 z'^2 = 0. From p = (I - 2 lambda diag(1, 1, -c^2)) v there are two v for
// one p, its projections on the two rays in the plane of p and the z axis. With s = +1 or -1 the
// sign of z' (cP + s p_z) and P = |(p_x, p_y)|,
//
//   v = w (c p_x/P, c p_y/P, s),  w = (cP + s p_z)/(1 + c^2),  H = (1 + c^2) w^2/2 + V,
//   lambda = (s c p_z - P) / (2c (cP + s p_z)).
//
// So for c = 1 and p = (1.2, 0.5, 0.7) the multipliers are -0.15 and -5/3. At v = 0, and where
// P = 0, the direction is lost: H_yy is singular there.
// Invariants: H, x p_y - y p_x, and p_z without gravity; p_x and p_y without stiffness.
// Source: Appell, Rend. Circ. Mat. Palermo 32 (1911); here as the constraint of a variational
// problem, not of nonholonomic mechanics.
#pragma once

#include <array>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Appell {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  double c = 1;          // horizontal speed over vertical speed
  double gravity = 0;    // along -z
  double stiffness = 0;  // of a spring to the z axis, per unit mass

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/, const Vector<T, 3>& q, const Vector<T, 3>& v) const {
    const T spring = stiffness * (q[0] * q[0] + q[1] * q[1]);
    return 0.5 * (dot(v, v) - spring) - gravity * q[2];
  }

  template <class T>
  [[nodiscard]] Vector<T, 1> constraint(const Vector<T, 3>& /*q*/, const Vector<T, 3>& v) const {
    return Vector<T, 1>(v[0] * v[0] + v[1] * v[1] - c * c * v[2] * v[2]);
  }

  // The velocity without the constraint: at v = 0 no direction is better than another.
  template <class T>
  [[nodiscard]] Vector<T, 3> velocity_guess(const T& /*t*/,
                                            const Vector<T, 3>& /*q*/,
                                            const Vector<T, 3>& p) const {
    return p;
  }

  // lambda of the branch with this sign.
  [[nodiscard]] double multiplier(const Vector<double, 3>& p, int sign) const {
    const double horizontal = std::hypot(p[0], p[1]);
    return (sign * c * p[2] - horizontal) / (2 * c * (c * horizontal + sign * p[2]));
  }

  // (q, p) at time t on that branch. Without stiffness only: p_z falls and w with it, evenly.
  [[nodiscard]] Vector<double, 6> closed_form(const Vector<double, 3>& q,
                                              const Vector<double, 3>& p,
                                              int sign,
                                              double t) const {
    const double horizontal = std::hypot(p[0], p[1]);
    const double mean_p_z = p[2] - 0.5 * gravity * t;
    const double way = t * (c * horizontal + sign * mean_p_z) / (1 + c * c);
    Vector<double, 6> z;
    z << q[0] + way * c * p[0] / horizontal, q[1] + way * c * p[1] / horizontal, q[2] + sign * way,
        p[0], p[1], p[2] - gravity * t;
    return z;
  }

  static constexpr auto parameters() {
    using P = Parameter<Appell>;
    return std::array{
        P{"c", &Appell::c, "1", Range::positive(), "horizontal speed over vertical speed"},
        P{"gravity", &Appell::gravity, "length/time^2", Range{}, "acceleration along -z"},
        P{"stiffness",
          &Appell::stiffness,
          "1/time^2",
          Range{},
          "of a spring to the z axis, per unit mass"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "appell";
    info.summary = "Appell's constraint x'^2 + y'^2 = c^2 z'^2, not linear in the velocities";
    info.reference = "Appell, Rend. Circ. Mat. Palermo 32 (1911)";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length", 0}};
    info.symmetries.mirrors = {{-1, 1, 1}, {1, -1, 1}};
    if (gravity == 0) info.symmetries.mirrors.push_back({1, 1, -1});
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
