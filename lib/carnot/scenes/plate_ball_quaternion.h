// A unit ball that rolls on a plane without slip or spin, its attitude a unit quaternion.
//
// Contact point (x, y); q = (w, x, y, z) rotates body to space, and 2 q' conj(q) = (0, Omega) with
// the rates Omega in space on |q| = 1, Omega_x = 2 (i q).q' and so on. Rolling:
//
//   y' + Omega_x = 0,    -x' + Omega_y = 0,    Omega_z = 0,    h = |q|^2 - 1,
//
// cost (x'^2 + y'^2)/2. The first two terms are multiplied by |q|^2, so that off the manifold the
// ball rolls too, with the attitude q/|q|: x' = u1, y' = u2, q' = (-u2 i q + u1 j q + u3 q)/2. The
// cost counts 2 q.q'/|q|^2 = u3 like a third velocity, zero on the manifold: else M would not be
// positive along q, a direction that the manifold does not have. log |q| moves apart from the
// rest. q and -q are the same attitude.
// The scene plate-ball is the same in Euler angles. Invariants: H, p_x, p_y, the momenta of turns
// of the ball in the body, (q i).p_q and so on, and x p_y - y p_x + (k q).p_q/2. Source: Jurdjevic,
// Arch. Rational Mech. Anal. 124 (1993).
#pragma once

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/quaternion.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct PlateBallQuaternion {
  static constexpr int kDof = 6;
  static constexpr int kMultipliers = 3;
  static constexpr int kHolonomic = 1;
  static constexpr bool kProduct = true;

  template <class T>
  [[nodiscard]] Matrix<T, 6, 6> mass(const Vector<T, 6>& q) const {
    Matrix<T, 6, 6> m = Matrix<T, 6, 6>::Zero();
    m(0, 0) = m(1, 1) = 1;
    const Vector<T, 4> attitude = q.template tail<4>();
    const T square = dot(attitude, attitude);
    const T scale = T(4) / (square * square);
    for (int i = 2; i < 6; ++i) {
      for (int j = 2; j < 6; ++j) m(i, j) = scale * q[i] * q[j];
    }
    return m;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 6> constraints(const Vector<T, 6>& q) const {
    const Vector<T, 4> attitude = q.template tail<4>();
    const Matrix<T, 4, 4> rates = space_rates(attitude);
    const T square = dot(attitude, attitude);
    Matrix<T, 3, 6> g = Matrix<T, 3, 6>::Zero();
    g(0, 1) = square;
    g(1, 0) = -square;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) g(i, 2 + j) = rates(1 + i, j);
    }
    return g;
  }

  template <class T>
  [[nodiscard]] Vector<T, 1> holonomic(const Vector<T, 6>& q) const {
    const Vector<T, 4> attitude = q.template tail<4>();
    return Vector<T, 1>(dot(attitude, attitude) - 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 6, 3> frame(const Vector<T, 6>& q) const {
    const Matrix<T, 4, 4> rates = space_rates(Vector<T, 4>(q.template tail<4>()));
    Matrix<T, 6, 3> b = Matrix<T, 6, 3>::Zero();
    b(0, 0) = b(1, 1) = 1;
    for (int j = 0; j < 4; ++j) {
      b(2 + j, 0) = 0.25 * rates(2, j);
      b(2 + j, 1) = -0.25 * rates(1, j);
      b(2 + j, 2) = 0.25 * rates(0, j);
    }
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_masses(const Vector<T, 6>& /*q*/) const {
    return Vector<T, 3>::Constant(1);
  }

  // d/dq [p.B u - u'B'M B u/2]: the attitude has B u = c q with the quaternion
  // c = (u3, -u2, u1, 0)/2.
  template <class T>
  [[nodiscard]] Vector<T, 6> frame_gradient(const Vector<T, 6>& /*q*/,
                                            const Vector<T, 6>& p,
                                            const Vector<T, 3>& u) const {
    const Vector<T, 4> conj_c(0.5 * u[2], 0.5 * u[1], -0.5 * u[0], 0);
    const Vector<T, 4> by_attitude = quaternion_product(conj_c, Vector<T, 4>(p.template tail<4>()));
    Vector<T, 6> gradient;
    gradient << 0, 0, by_attitude;
    return gradient;
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "plate-ball-quaternion";
    info.summary = "a ball rolls on a plane without slip or spin, its attitude a unit quaternion";
    info.reference = "Jurdjevic, Arch. Rational Mech. Anal. 124 (1993)";
    info.configuration = {{"x", "length", 0},
                          {"y", "length", 0},
                          {"qw", "1", 0},
                          {"qx", "1", 0},
                          {"qy", "1", 0},
                          {"qz", "1", 0}};
    info.symmetries.mirrors = {
        {1, 1, -1, -1, -1, -1}, {1, -1, 1, -1, 1, -1}, {-1, 1, 1, 1, -1, -1}};
    info.drawing = {.view = Drawing::View::kPlane,
                    .body =
                        [](const double* q) {
                          constexpr double kShown = 0.15;  // of the radius
                          return globe({q[0], q[1]}, kShown, attitude_of_quaternion(q + 2));
                        },
                    .glyph = "ball from above, drawn small"};
    return info;
  }
};

}  // namespace carnot::scenes
