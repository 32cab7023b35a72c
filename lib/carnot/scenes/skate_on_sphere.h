// A skate on the unit sphere: at x, along the tangent direction e, no slip sideways.
//
//   h = ((|x|^2 - 1)/2, (|e|^2 - 1)/2, x.e),    g: (x cross e).x' = 0,
//
// cost (|x'|^2 + beta^2 |e'|^2)/2. With n = x cross e the admissible velocities on the manifold are
//
//   x' = u1 e,    e' = -u1 x + u2 n,    cost ((1 + beta^2) u1^2 + beta^2 u2^2)/2:
//
// drive along a great circle, turn about x. (x, e, n) is a rotation and u a body rate of it, so
// this is a left-invariant sub-Riemannian problem on SO(3), as the unicycle is one on SE(2).
// In longitude phi, latitude theta and heading psi from the east: phi' cos(theta) = u1 cos(psi),
// theta' = u1 sin(psi), psi' = u2 - phi' sin(theta).
// Invariants: H and the vector x cross p_x + e cross p_e.
// Source: Montgomery, A Tour of Subriemannian Geometries (2002); Boscain & Rossi (2008) for SO(3).
#pragma once

#include <array>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct SkateOnSphere {
  static constexpr int kDof = 6;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;
  static constexpr int kHolonomic = 3;

  double beta = 1;  // turning by one radian costs as much as driving this far

  template <class T>
  [[nodiscard]] Matrix<T, 6, 6> mass(const Vector<T, 6>& /*q*/) const {
    Matrix<T, 6, 6> m = Matrix<T, 6, 6>::Zero();
    for (int i = 0; i < 3; ++i) {
      m(i, i) = 1;
      m(3 + i, 3 + i) = beta * beta;
    }
    return m;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 6> constraints(const Vector<T, 6>& q) const {
    Matrix<T, 1, 6> g;
    g << q[1] * q[5] - q[2] * q[4], q[2] * q[3] - q[0] * q[5], q[0] * q[4] - q[1] * q[3], 0, 0, 0;
    return g;
  }

  template <class T>
  [[nodiscard]] Vector<T, 3> holonomic(const Vector<T, 6>& q) const {
    const Vector<T, 3> x = q.template head<3>();
    const Vector<T, 3> e = q.template tail<3>();
    return {0.5 * (dot(x, x) - 1), 0.5 * (dot(e, e) - 1), dot(x, e)};
  }

  // x' along x or e, any e'.
  template <class T>
  [[nodiscard]] Matrix<T, 6, 5> frame(const Vector<T, 6>& q) const {
    Matrix<T, 6, 5> b = Matrix<T, 6, 5>::Zero();
    for (int i = 0; i < 3; ++i) {
      b(i, 0) = q[i];
      b(i, 1) = q[3 + i];
      b(3 + i, 2 + i) = 1;
    }
    return b;
  }

  // B'M B.
  template <class T>
  [[nodiscard]] Matrix<T, 5, 5> frame_mass(const Vector<T, 6>& q) const {
    const Vector<T, 3> x = q.template head<3>();
    const Vector<T, 3> e = q.template tail<3>();
    Matrix<T, 5, 5> a = Matrix<T, 5, 5>::Zero();
    a(0, 0) = dot(x, x);
    a(0, 1) = a(1, 0) = dot(x, e);
    a(1, 1) = dot(e, e);
    a(2, 2) = a(3, 3) = a(4, 4) = beta * beta;
    return a;
  }

  // d/dq [p.B u - u'B'M B u/2]: x' = u1 x + u2 e is what depends on q.
  template <class T>
  [[nodiscard]] Vector<T, 6> frame_gradient(const Vector<T, 6>& q,
                                            const Vector<T, 6>& p,
                                            const Vector<T, 5>& u) const {
    Vector<T, 6> gradient;
    for (int i = 0; i < 3; ++i) {
      const T excess = p[i] - (u[0] * q[i] + u[1] * q[3 + i]);
      gradient[i] = u[0] * excess;
      gradient[3 + i] = u[1] * excess;
    }
    return gradient;
  }

  static constexpr auto parameters() {
    using P = Parameter<SkateOnSphere>;
    return std::array{P{"beta",
                        &SkateOnSphere::beta,
                        "length",
                        Range::positive(),
                        "turning by one radian costs as much as driving this far"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "skate-on-sphere";
    info.summary = "a skate on the unit sphere: a sub-Riemannian problem on SO(3)";
    info.reference = "Boscain & Rossi, SIAM J. Control Optim. 47 (2008)";
    info.configuration = {{"x1", "length", 0},
                          {"x2", "length", 0},
                          {"x3", "length", 0},
                          {"e1", "1", 0},
                          {"e2", "1", 0},
                          {"e3", "1", 0}};
    info.symmetries.mirrors = {
        {-1, 1, 1, -1, 1, 1}, {1, -1, 1, 1, -1, 1}, {1, 1, -1, 1, 1, -1}, {1, 1, 1, -1, -1, -1}};
    info.drawing = {.view = Drawing::View::kSpace,
                    .body_in_space =
                        [](const double* q) {
                          constexpr double kArrow = 0.25;
                          return arrow_on_sphere({q[0], q[1], q[2]}, {q[3], q[4], q[5]}, kArrow);
                        },
                    .sphere = 1,
                    .glyph = "heading of the skate"};
    return info;
  }
};

}  // namespace carnot::scenes
