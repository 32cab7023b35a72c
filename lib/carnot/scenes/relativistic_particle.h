// A relativistic charge in a uniform magnetic field along z: L is not quadratic in v.
//
//   L = -m c^2 sqrt(1 - |v|^2/c^2) + e A.v,   A = field (-y, x, 0)/2.
//
// p = gamma m v + e A, and H = sqrt(m^2 c^4 + c^2 |p - eA|^2) = gamma m c^2. |v| and gamma are
// constant; the particle moves on a helix, clockwise about the field for e field > 0 with
// w = e field/(gamma m):
//
//   x' + i y' = (x' + i y')(0) exp(-i w t),   z' = z'(0).
//
// Invariants: H, p_z, x p_y - y p_x. Reversing time needs a mirror besides, such as y -> -y, since
// the field stays as it is. Source: Landau & Lifshitz, The Classical Theory of Fields (1975),
// sec. 21.
#pragma once

#include <array>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/stumpff.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct RelativisticParticle {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 0;

  double mass = 1;
  double light = 1;  // speed of light
  double charge = 1;
  double field = 1;

  // Not a number where |v| >= light.
  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/, const Vector<T, 3>& q, const Vector<T, 3>& v) const {
    using std::sqrt;
    const T beta2 = dot(v, v) / (light * light);
    const T swept = 0.5 * (q[0] * v[1] - q[1] * v[0]);
    return charge * field * swept - mass * light * light * sqrt(1 - beta2);
  }

  // (q, p) at time t; Stumpff functions keep the digits as the field vanishes.
  [[nodiscard]] Vector<double, 6> closed_form(const Vector<double, 3>& q,
                                              const Vector<double, 3>& p,
                                              double t) const {
    const double half = 0.5 * charge * field;
    const Vector<double, 3> kinetic(p[0] + half * q[1], p[1] - half * q[0], p[2]);
    const double gamma_mass =
        std::sqrt(mass * mass + kinetic.squaredNorm() / (light * light));  // gamma m
    const Vector<double, 3> v = kinetic / gamma_mass;
    const double turn = 2 * half / gamma_mass * t;         // w t
    const double s = t * stumpff<1>(turn * turn);          // sin(w t)/w
    const double c1 = t * turn * stumpff<2>(turn * turn);  // (1 - cos(w t))/w
    const Vector<double, 3> x(
        q[0] + v[0] * s + v[1] * c1, q[1] + v[1] * s - v[0] * c1, q[2] + v[2] * t);
    const double cosine = std::cos(turn);
    const double sine = std::sin(turn);
    Vector<double, 6> z;
    z << x, gamma_mass * (v[0] * cosine + v[1] * sine) - half * x[1],
        gamma_mass * (v[1] * cosine - v[0] * sine) + half * x[0], p[2];
    return z;
  }

  static constexpr auto parameters() {
    using P = Parameter<RelativisticParticle>;
    return std::array{
        P{"mass", &RelativisticParticle::mass, "mass", Range::positive(), "rest mass"},
        P{"light",
          &RelativisticParticle::light,
          "length/time",
          Range::positive(),
          "speed of light"},
        P{"charge", &RelativisticParticle::charge, "charge", Range{}, "electric charge"},
        P{"field",
          &RelativisticParticle::field,
          "mass/(charge time)",
          Range{},
          "magnetic field along z"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "relativistic-particle";
    info.summary = "a relativistic charge in a uniform magnetic field: L not quadratic in q'";
    info.reference = "Landau & Lifshitz, The Classical Theory of Fields (1975), sec. 21";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}, {"z", "length", 0}};
    info.symmetries.mirrors = {{-1, -1, 1}, {1, 1, -1}};
    info.drawing.view = Drawing::View::kSpace;
    return info;
  }
};

}  // namespace carnot::scenes
