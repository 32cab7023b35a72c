// A falling cat: three equal links in the plane that turn without angular momentum.
//
// Links of unit mass and half-length 1. With e(s) = (cos s, sin s) the middle one has heading theta
// and the others are hinged to its ends: centres at e(theta) + e(theta + a) and at
// -e(theta) - e(theta + b) from that of the middle one. Zero angular momentum about the common
// centre of mass is the one constraint, I theta' + A a' + B b' = 0 with
//
//   I = 13/3 + 2 cos a + 2 cos b + 2/3 cos(a - b),   inertia of the rigid cat, >= 1,
//   A = 1 + cos a + cos(a - b)/3,   B = 1 + cos b + cos(a - b)/3.
//
// M = diag(1, 1, 1). The frame is the shape (a, b): theta' = -(A a' + B b')/I. This is a gauge
// field: a loop of shapes turns the cat by the integral of its curvature over the area inside.
//
// Invariants: H, p_theta.
// Source: Montgomery, Gauge theory of the falling cat, Fields Inst. Commun. 1 (1993).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct FallingCat {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;
  static constexpr bool kConstantMass = true;

  template <class T>
  [[nodiscard]] Matrix<T, 3, 3> mass(const Vector<T, 3>& /*q*/) const {
    return diagonal<T>(1, 1, 1);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 1, 3> constraints(const Vector<T, 3>& q) const {
    using std::cos;
    const T third = T(Real<T>(1) / 3);
    const T c = third * cos(q[1] - q[2]);
    return {
        T(Real<T>(13) / 3) + 2 * (cos(q[1]) + cos(q[2]) + c), 1 + cos(q[1]) + c, 1 + cos(q[2]) + c};
  }

  template <class T>
  [[nodiscard]] Matrix<T, 3, 2> frame(const Vector<T, 3>& q) const {
    const Matrix<T, 1, 3> g = constraints(q);
    Matrix<T, 3, 2> b;
    // clang-format off
    b << -g(0, 1) / g(0, 0), -g(0, 2) / g(0, 0),
         1,                  0,
         0,                  1;
    // clang-format on
    return b;
  }

  // d/dq [p.B u - u'B'M B u/2]: a and b enter by theta' only.
  template <class T>
  [[nodiscard]] Vector<T, 3> frame_gradient(const Vector<T, 3>& q,
                                            const Vector<T, 3>& p,
                                            const Vector<T, 2>& u) const {
    using std::sin;
    const Matrix<T, 1, 3> g = constraints(q);
    const T theta_dot = -(g(0, 1) * u[0] + g(0, 2) * u[1]) / g(0, 0);
    const T s = T(Real<T>(1) / 3) * sin(q[1] - q[2]);
    // -d/da (I theta' + A a' + B b') at frozen velocity, and the same for b.
    const T by_a = sin(q[1]) * (2 * theta_dot + u[0]);
    const T by_b = sin(q[2]) * (2 * theta_dot + u[1]);
    const T by_both = s * (2 * theta_dot + u[0] + u[1]);
    const T slope = (p[0] - theta_dot) / g(0, 0);
    return {0, slope * (by_a + by_both), slope * (by_b - by_both)};
  }

  [[nodiscard]] SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    SceneInfo info;
    info.name = "falling-cat";
    info.summary = "three hinged links in the plane that turn without angular momentum";
    info.reference = "Montgomery, Gauge theory of the falling cat, Fields Inst. Commun. 1 (1993)";
    info.configuration = {{"theta", "rad", kTurn}, {"a", "rad", kTurn}, {"b", "rad", kTurn}};
    info.symmetries.mirrors = {{-1, -1, -1}};
    info.symmetries.cyclic = {0};
    info.drawing = {.view = Drawing::View::kPlane,
                    .axes = {1, 2, 0},
                    .body = body,
                    .path = "the shape",
                    .glyph = "the cat, small"};
    info.extremes = {{"largest_bend", "rad", [](const double* q) {
                        return std::max(std::abs(q[1]), std::abs(q[2]));
                      }}};
    return info;
  }

 private:
  // The cat, small, about its centre of mass, at its shape (a, b).
  static std::vector<Polyline> body(const double* q) {
    constexpr double kHalfLength = 0.06;  // rad
    using Point = std::array<double, 2>;
    const auto along = [](const Point& from, double links, double heading) {
      const double length = links * kHalfLength;
      return Point{from[0] + length * std::cos(heading), from[1] + length * std::sin(heading)};
    };
    Point middle = along({q[1], q[2]}, -1.0 / 3, q[0] + q[1]);
    middle = along(middle, 1.0 / 3, q[0] + q[2]);
    const Point front = along(middle, 1, q[0]);
    const Point back = along(middle, -1, q[0]);
    return {{Polyline::Role::kBody,
             {along(front, 2, q[0] + q[1]), front, back, along(back, -2, q[0] + q[2])}}};
  }
};

}  // namespace carnot::scenes
