// The two-wheeled vehicle of McLachlan et al. (2013), section 5.
//
// Front wheel at (x, y) with absolute heading phi, body along theta, rear wheel at
// (x - l cos theta, y - l sin theta). Neither wheel slips sideways (eqs. 18, 20):
//
//   x' sin phi - y' cos phi = 0,      x' sin theta - y' cos theta + l theta' = 0,
//
// L = (x'^2 + y'^2 + alpha theta'^2 + beta phi'^2)/2, V = 0. The admissible velocities are spanned
// by driving, u1, and steering, u2, with delta = phi - theta the steering angle:
//
//   x' = u1 cos phi,  y' = u1 sin phi,  theta' = u1 sin(delta)/l,  phi' = u2.
//
// Invariants: H, p_x, p_y, and x p_y - y p_x + p_theta + p_phi.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Vehicle {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 2;
  static constexpr bool kConstantMass = true;

  double alpha = 1;   // inertia of the body about the front wheel, per unit mass
  double beta = 1;    // inertia of the steered wheel, per unit mass
  double length = 1;  // wheelbase

  template <class T>
  [[nodiscard]] Matrix<T, 4, 4> mass(const Vector<T, 4>& /*q*/) const {
    return diagonal<T>(1, 1, alpha, beta);
  }

  template <class T>
  [[nodiscard]] Matrix<T, 2, 4> constraints(const Vector<T, 4>& q) const {
    using std::cos, std::sin;
    Matrix<T, 2, 4> g;
    // clang-format off
    g << sin(q[3]), -cos(q[3]), 0,      0,
         sin(q[2]), -cos(q[2]), length, 0;
    // clang-format on
    return g;
  }

  template <class T>
  [[nodiscard]] Matrix<T, 4, 2> frame(const Vector<T, 4>& q) const {
    using std::cos, std::sin;
    Matrix<T, 4, 2> b;
    // clang-format off
    b << cos(q[3]),                       0,
         sin(q[3]),                       0,
         sin(q[3] - q[2]) * (1 / length), 0,
         0,                               1;
    // clang-format on
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, 4>& q) const {
    using std::sin;
    const T turn = sin(q[3] - q[2]) * (1 / length);
    return {1 + alpha * turn * turn, beta};
  }

  // d/dq [p.B u - u'B'M B u/2]: theta and phi enter by phi and delta only.
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& q,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    const T delta = q[3] - q[2];
    const T turn = u[0] * cos(delta) * (1 / length);  // d theta' / d delta
    const T theta_dot = u[0] * sin(delta) * (1 / length);
    const T by_delta = turn * (p[2] - alpha * theta_dot);
    Vector<T, 4> gradient;
    gradient[0] = gradient[1] = 0;
    gradient[2] = -by_delta;
    gradient[3] = by_delta + u[0] * (p[1] * cos(q[3]) - p[0] * sin(q[3]));
    return gradient;
  }

  static constexpr auto parameters() {
    using P = Parameter<Vehicle>;
    return std::array{
        P{"alpha",
          &Vehicle::alpha,
          "length^2",
          Range::non_negative(),
          "inertia of the body about the front wheel, per unit mass"},
        P{"beta",
          &Vehicle::beta,
          "length^2",
          Range::positive(),
          "inertia of the steered wheel, per unit mass"},
        P{"length", &Vehicle::length, "length", Range::positive(), "distance between the wheels"}};
  }

  [[nodiscard]] SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    SceneInfo info;
    info.name = "vehicle";
    info.summary = "two-wheeled vehicle, V = 0: the parallel parking problem";
    info.reference = "McLachlan, Modin, Verdier & Wilkins, SIAM J. Sci. Comput. 35 (2013), sec. 5";
    info.configuration = {
        {"x", "length", 0}, {"y", "length", 0}, {"theta", "rad", kTurn}, {"phi", "rad", kTurn}};
    info.symmetries = {.mirrors = {{1, -1, -1, -1}}, .x = 0, .y = 1, .angles = {2, 3}};
    info.drawing = {.view = Drawing::View::kPlane,
                    .body = [l = length](const double* q) { return body(l, q); }};
    info.extremes = {
        {"largest_steering_angle", "rad", [](const double* q) { return q[3] - q[2]; }}};
    return info;
  }

 private:
  static std::vector<Polyline> body(double length, const double* q) {
    constexpr double kLength = 1.5;  // all as multiples of the wheelbase
    constexpr double kWidth = 0.4;
    constexpr double kWheelRadius = 0.14;
    const double dx = length * std::cos(q[2]);
    const double dy = length * std::sin(q[2]);
    return {rectangle({q[0] - dx / 2, q[1] - dy / 2}, q[2], kLength * length, kWidth * length),
            wheel({q[0] - dx, q[1] - dy}, q[2], kWheelRadius * length),
            wheel({q[0], q[1]}, q[3], kWheelRadius * length)};
  }
};

}  // namespace carnot::scenes
