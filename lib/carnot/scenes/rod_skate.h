// A rigid rod with a skate: two unit masses at r1 = (x1, y1) and r2 = (x2, y2), one unit apart, the
// skate at their middle along the rod, gravity 1 along -y.
//
//   h = |r2 - r1|^2 - 1,    g = (d_y, -d_x, d_y, -d_x) with d = r2 - r1,    V = y1 + y2,    M = I.
//
// Admissible velocities, at any length of the rod: both masses along d, u1; along d but opposite,
// u2; a turn about the middle, u3. On the manifold u2 = 0.
// Invariants: H, p_x1 + p_x2, p_y1 + p_y2 + 2t.
// In its own coordinates, the middle and the heading, it is a unicycle with gravity.
// Source: McLachlan, Modin, Verdier & Wilkins (2013), section 4: Prop. 5 and 6.
#pragma once

#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct RodSkate {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;
  static constexpr int kHolonomic = 1;

  template <class T>
  [[nodiscard]] Matrix<T, 4, 4> mass(const Vector<T, 4>& /*q*/) const {
    return diagonal<T>(1, 1, 1, 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 4> constraints(const Vector<T, 4>& q) const {
    const T dx = q[2] - q[0];
    const T dy = q[3] - q[1];
    return {dy, -dx, dy, -dx};
  }

  template <class T>
  [[nodiscard]] Vector<T, 1> holonomic(const Vector<T, 4>& q) const {
    const T dx = q[2] - q[0];
    const T dy = q[3] - q[1];
    return Vector<T, 1>(dx * dx + dy * dy - 1);
  }

  template <class T>
  [[nodiscard]] T potential(const Vector<T, 4>& q) const {
    return q[1] + q[3];
  }

  template <class T>
  [[nodiscard]] Matrix<T, 4, 3> frame(const Vector<T, 4>& q) const {
    const T dx = q[2] - q[0];
    const T dy = q[3] - q[1];
    Matrix<T, 4, 3> b;
    // clang-format off
    b << dx, -dx,  dy,
         dy, -dy, -dx,
         dx,  dx, -dy,
         dy,  dy,  dx;
    // clang-format on
    return b;
  }

  // The diagonal of B'M B = 2 |d|^2 I.
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_masses(const Vector<T, 4>& q) const {
    const T dx = q[2] - q[0];
    const T dy = q[3] - q[1];
    return Vector<T, 3>::Constant(2 * (dx * dx + dy * dy));
  }

  // d/dq [p.B u - u'B'M B u/2 + V]: but for V, d alone enters.
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& q,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 3>& u) const {
    const T square = 2 * dot(u, u);
    const T opposite_x = p[2] - p[0];
    const T opposite_y = p[3] - p[1];
    const T x = u[0] * (p[0] + p[2]) + u[1] * opposite_x + u[2] * opposite_y;
    const T y = u[0] * (p[1] + p[3]) + u[1] * opposite_y - u[2] * opposite_x;
    const T by_dx = x - square * (q[2] - q[0]);
    const T by_dy = y - square * (q[3] - q[1]);
    return {-by_dx, 1 - by_dy, by_dx, 1 + by_dy};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "rod-skate";
    info.summary = "two masses on a rigid rod that glides on a skate, with gravity";
    info.reference = "McLachlan, Modin, Verdier & Wilkins, SIAM J. Sci. Comput. 35 (2013), sec. 4";
    info.configuration = {
        {"x1", "length", 0}, {"y1", "length", 0}, {"x2", "length", 0}, {"y2", "length", 0}};
    info.symmetries.mirrors = {{-1, 1, -1, 1}};
    info.drawing = {.view = Drawing::View::kPlane, .body = body};
    return info;
  }

 private:
  static std::vector<Polyline> body(const double* q) {
    constexpr double kSkate = 0.15;  // half its length, of the rod's
    const double x = 0.5 * (q[0] + q[2]);
    const double y = 0.5 * (q[1] + q[3]);
    const double dx = kSkate * (q[2] - q[0]);
    const double dy = kSkate * (q[3] - q[1]);
    return {{Polyline::Role::kBody, {{q[0], q[1]}, {q[2], q[3]}}},
            {Polyline::Role::kWheel, {{x - dx, y - dy}, {x + dx, y + dy}}}};
  }
};

}  // namespace carnot::scenes
