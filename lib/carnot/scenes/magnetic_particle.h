// A fast charge in a uniform magnetic field and a harmonic trap, in its kinetic momenta.
//
// z = (x, y, pi_x, pi_y, w_x, w_y): place, kinetic momentum and velocity. The velocity is a
// variable of its own, in the kernel of J, because the kinetic part of the Lagrangian,
//
//   K(w) = m |w|^2/2 (1 + |w|^2 / (4 c^2)),
//
// the first two terms of -m c^2 sqrt(1 - |w|^2/c^2), cannot be inverted in closed form. With the
// field b (charge times field) and the stiffness k of the trap,
//
//        ( B -I  0 )       (  0  b )
//   J =  ( I  0  0 ),  B = ( -b  0 ),     H = pi.w - K(w) + k (x^2 + y^2)/2,
//        ( 0  0  0 )
//
// so x' = w, pi' = B w - k x and H_w = 0: pi = m w (1 + |w|^2 / (2 c^2)). J is canonical in
// (x, y, p_x, p_y) with p = pi + b (-y, x)/2, momenta in the symmetric gauge: the scene says so,
// and its configuration is (x, y), its multipliers the velocity. H_ww = -K'' < 0: index 1
// everywhere, one branch.
//
// Invariants: H, and x p_y - y p_x. Without a trap |w| is constant and the path is a circle run
// through with the angular velocity -b / (m (1 + |w|^2 / (2 c^2))), the slower the faster it moves.
// Source: Landau & Lifshitz, The Classical Theory of Fields (1975), sections 21 and 65.
#pragma once

#include <array>
#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/stumpff.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct MagneticParticle {
  static constexpr int kSize = 6;
  static constexpr int kDof = 2;

  double mass = 1;         // m
  double field = 1;        // b
  double light_speed = 1;  // c
  double stiffness = 1;    // k

  template <class T>
  [[nodiscard]] T hamiltonian(const Vector<T, 6>& z) const {
    const T speed2 = z[4] * z[4] + z[5] * z[5];
    const T fast = 1 + speed2 / (4 * light_speed * light_speed);
    const T kinetic = 0.5 * mass * speed2 * fast;
    const T trap = 0.5 * stiffness * (z[0] * z[0] + z[1] * z[1]);
    return z[2] * z[4] + z[3] * z[5] - kinetic + trap;
  }

  [[nodiscard]] Matrix<double, 6, 6> structure_matrix() const {
    Matrix<double, 6, 6> j;
    // clang-format off
    j <<      0, field, -1,  0, 0, 0,
         -field,     0,  0, -1, 0, 0,
              1,     0,  0,  0, 0, 0,
              0,     1,  0,  0, 0, 0,
              0,     0,  0,  0, 0, 0,
              0,     0,  0,  0, 0, 0;
    // clang-format on
    return j;
  }

  // pi = p + b (y, -x)/2.
  [[nodiscard]] Matrix<double, 6, 6> darboux_basis() const {
    Matrix<double, 6, 6> t = Matrix<double, 6, 6>::Identity();
    t(2, 1) = 0.5 * field;
    t(3, 0) = -0.5 * field;
    return t;
  }

  // m (1 + |w|^2 / (2 c^2)): pi over w.
  [[nodiscard]] double inertia(const Vector<double, 2>& w) const {
    return mass * (1 + w.squaredNorm() / (2 * light_speed * light_speed));
  }

  // Place and velocity (x, y, w_x, w_y) after time t without a trap. Stumpff functions keep the
  // digits as the field goes to zero.
  [[nodiscard]] Vector<double, 4> gyration(const Vector<double, 2>& x,
                                           const Vector<double, 2>& w,
                                           double t) const {
    const double turn = -field / inertia(w) * t;
    const double s = t * stumpff<1>(turn * turn);         // of the velocity
    const double c = t * turn * stumpff<2>(turn * turn);  // of the velocity, turned by pi/2
    const double cosine = std::cos(turn);
    const double sine = std::sin(turn);
    return {x[0] + s * w[0] - c * w[1],
            x[1] + s * w[1] + c * w[0],
            cosine * w[0] - sine * w[1],
            cosine * w[1] + sine * w[0]};
  }

  static constexpr auto parameters() {
    using P = Parameter<MagneticParticle>;
    return std::array{
        P{"mass", &MagneticParticle::mass, "mass", Range::positive(), "mass at rest"},
        P{"field", &MagneticParticle::field, "mass/time", Range{}, "charge times magnetic field"},
        P{"light_speed",
          &MagneticParticle::light_speed,
          "length/time",
          Range::positive(),
          "speed at which the fourth-order term of the kinetic energy matters"},
        P{"stiffness",
          &MagneticParticle::stiffness,
          "mass/time^2",
          Range::non_negative(),
          "stiffness of the trap"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "magnetic-particle";
    info.summary = "a fast charge in a magnetic field and a trap; the multipliers are its velocity";
    info.reference = "Landau & Lifshitz, The Classical Theory of Fields (1975), sec. 21";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}};
    info.symmetries.mirrors = {{-1, -1}};
    info.drawing.view = Drawing::View::kPlane;
    return info;
  }
};

}  // namespace carnot::scenes
