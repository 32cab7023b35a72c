// A satellite turned by two wheels, its attitude a unit quaternion: no chart, no singularity.
//
// q = (w, x, y, z) rotates body to space, and 2 conj(q) q' = (0, omega) with the body rates omega
// on |q| = 1. With the vectors q i, q j, q k (products of quaternions, linear in q)
//
//   omega_x = 2 (q i).q',   omega_y = 2 (q j).q',   g = omega_z = 2 (q k).q' = 0,   h = |q|^2 - 1,
//
// cost (j1 omega_x^2 + j2 omega_y^2 + omega_z^2)/2. M would be singular along q itself, a direction
// that the manifold does not have: the cost counts 2 q.q' like a fourth rate, which is zero there.
// Off the manifold all four are those of q/|q| and log |q|^2, divided by |q|^2: the admissible
// velocities are q' = (u1 q i + u2 q j + u3 q)/2, with u the rates, and log |q| moves apart from
// the attitude. g is not divided. q and -q are the same attitude. The scene satellite is the same
// in Euler angles. Invariants: H and the angular momentum in space, (i q).p/2, (j q).p/2, (k
// q).p/2.
#pragma once

#include <array>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/quaternion.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct SatelliteQuaternion {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 1;
  static constexpr int kHolonomic = 1;
  static constexpr bool kProduct = true;

  double j1 = 1;  // moments of inertia about the body axes, relative to the third
  double j2 = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 4, 4> mass(const Vector<T, 4>& q) const {
    const Matrix<T, 4, 4> rates = body_rates(q);
    const Vector<T, 4> inertia(1, j1, j2, 1);
    const T square = dot(q, q);
    const T scale = T(1) / (square * square);
    Matrix<T, 4, 4> weighted = rates;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) weighted(i, j) = scale * inertia[i] * rates(i, j);
    }
    return product(rates.transpose(), weighted);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 4> constraints(const Vector<T, 4>& q) const {
    return body_rates(q).row(3);
  }

  template <class T>
  [[nodiscard]] Vector<T, 1> holonomic(const Vector<T, 4>& q) const {
    return Vector<T, 1>(dot(q, q) - 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 4, 3> frame(const Vector<T, 4>& q) const {
    const Matrix<T, 4, 4> rates = body_rates(q);
    Matrix<T, 4, 3> b;
    for (int i = 0; i < 4; ++i) {
      b(i, 0) = 0.25 * rates(1, i);
      b(i, 1) = 0.25 * rates(2, i);
      b(i, 2) = 0.25 * rates(0, i);
    }
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_masses(const Vector<T, 4>& /*q*/) const {
    return {j1, j2, 1};
  }

  // d/dq [p.B u - u'B'M B u/2]: B u = q c with the quaternion c = (u3, u1, u2, 0)/2.
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& /*q*/,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 3>& u) const {
    const Vector<T, 4> conj_c(0.5 * u[2], -0.5 * u[0], -0.5 * u[1], 0);
    return quaternion_product(p, conj_c);
  }

  static constexpr auto parameters() {
    using P = Parameter<SatelliteQuaternion>;
    return std::array{
        P{"j1", &SatelliteQuaternion::j1, "1", Range::positive(), "weight of the first body rate"},
        P{"j2",
          &SatelliteQuaternion::j2,
          "1",
          Range::positive(),
          "weight of the second body rate"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "satellite-quaternion";
    info.summary = "a satellite turned by two wheels, its attitude a unit quaternion";
    info.reference = "Boscain & Rossi, SIAM J. Control Optim. 47 (2008)";
    info.configuration = {{"w", "1", 0}, {"x", "1", 0}, {"y", "1", 0}, {"z", "1", 0}};
    info.symmetries.mirrors = {{-1, -1, -1, -1}, {1, 1, -1, -1}, {1, -1, 1, -1}, {1, -1, -1, 1}};
    // The sphere of directions: where the body's x axis points, with its y axis as an arrow there.
    info.drawing = {.view = Drawing::View::kSpace,
                    .body_in_space =
                        [](const double* q) {
                          const Attitude axes = attitude_of_quaternion(q);
                          constexpr double kArrow = 0.25;
                          return arrow_on_sphere(axes[0], axes[1], kArrow);
                        },
                    .place = {{{{"X", "1", 0}, {"Y", "1", 0}, {"Z", "1", 0}}},
                              [](const double* q) { return attitude_of_quaternion(q)[0]; }},
                    .sphere = 1,
                    .path = "the body's x axis",
                    .glyph = "its y axis"};
    return info;
  }
};

}  // namespace carnot::scenes
