// A bicycle: rear axle at (x, y), frame along theta, front wheel turned by delta.
//
// Control by the speed u1 of the rear wheel and the rate u2 of steering,
//
//   x' = u1 cos theta,  y' = u1 sin theta,  theta' = u1 tan(delta)/l,  delta' = u2,
//
// cost (u1^2 + u2^2)/2. At cos(delta) = 0 the rear wheel cannot roll and the speed of the front
// wheel would have to serve as control (as in vehicle.h): the chart ends there.
// Invariants: H, p_x, p_y, x p_y - y p_x + p_theta.
// Source: De Luca, Oriolo & Samson, in Robot Motion Planning and Control, Springer (1998), ch. 4.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

struct Bicycle {
  static constexpr int kDof = 4;
  static constexpr int kControls = 2;

  double length = 1;  // wheelbase

  template <class T>
  [[nodiscard]] Matrix<T, 4, 2> frame(const Vector<T, 4>& q) const {
    using std::cos, std::sin, std::tan;
    Matrix<T, 4, 2> f;
    // clang-format off
    f << cos(q[2]),          0,
         sin(q[2]),          0,
         tan(q[3]) / length, 0,
         0,                  1;
    // clang-format on
    return f;
  }

  // d/dq [p.F u - u.u/2].
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& q,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    const T c = cos(q[3]);
    return {0, 0, u[0] * (p[1] * cos(q[2]) - p[0] * sin(q[2])), u[0] * p[2] / (length * c * c)};
  }

  template <class T>
  [[nodiscard]] T chart(const Vector<T, 4>& q) const {
    using std::cos;
    return cos(q[3]);
  }

  static constexpr auto parameters() {
    using P = Parameter<Bicycle>;
    return std::array{
        P{"length", &Bicycle::length, "length", Range::positive(), "distance between the wheels"}};
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info;
    info.name = "bicycle";
    info.summary = "a bicycle driven by its rear wheel: u1 rolls, u2 steers";
    info.reference = "De Luca, Oriolo & Samson, in Robot Motion Planning and Control (1998), ch. 4";
    // delta has no period: the end of the chart at pi/2 parts it from delta + pi.
    info.configuration = {{"x", "length", 0},
                          {"y", "length", 0},
                          {"theta", "rad", 2 * std::numbers::pi},
                          {"delta", "rad", 0}};
    // The second one drives backwards.
    info.symmetries = {.mirrors = {{1, -1, -1, -1}, {-1, 1, -1, 1}}, .x = 0, .y = 1, .angles = {2}};
    info.drawing = {.view = Drawing::View::kPlane,
                    .body = [l = length](const double* q) { return body(l, q); }};
    info.extremes = {{"largest_steering_angle", "rad", [](const double* q) { return q[3]; }}};
    return info;
  }

 private:
  static std::vector<Polyline> body(double length, const double* q) {
    constexpr double kWheelRadius = 0.15;  // of the wheelbase
    const double r = kWheelRadius * length;
    const double front_x = q[0] + length * std::cos(q[2]);
    const double front_y = q[1] + length * std::sin(q[2]);
    return {{Polyline::Role::kBody, {{q[0], q[1]}, {front_x, front_y}}},
            wheel({q[0], q[1]}, q[2], r),
            wheel({front_x, front_y}, q[2] + q[3], r)};
  }
};

}  // namespace carnot::scenes
