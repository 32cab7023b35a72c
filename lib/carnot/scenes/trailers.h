// A car that pulls trailers, each hooked up at the middle of the axle before it.
//
// The car is a unicycle at (x, y) with heading t0; trailer i has heading ti and its axle, at
// (x, y) - sum_{j=1..i} (cos tj, sin tj), follows on a rod of length 1. No axle slips sideways:
//
//   x' sin t0 - y' cos t0 = 0,
//   x' sin ti - y' cos ti + sum_{j=1..i} cos(ti - tj) tj' = 0.
//
// M = diag(1, 1, 1, w, ...): turning the car by one radian costs as much as driving one rod, and w
// is the weight of the trailers' turning. The admissible velocities are spanned by driving, u1, and
// turning, u2, with v_i the speed of axle i and d_i = t(i-1) - ti the angle at its hook:
//
//   x' = u1 cos t0,  y' = u1 sin t0,  t0' = u2,  ti' = v_(i-1) sin d_i,  v_i = v_(i-1) cos d_i.
//
// Invariants: H, p_x, p_y, and x p_y - y p_x + the momenta of all headings. For w = 0 trailers
// without momentum stay so and follow an extremal of the unicycle.
// Sources: Laumond, IEEE Trans. Robotics Automation 9 (1993); Fliess, Levine, Martin & Rouchon,
// Int. J. Control 61 (1995).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/scene/body.h"
#include "carnot/scene/scene_info.h"

namespace carnot::scenes {

template <int count>
struct Trailers {
  static_assert(count >= 1);
  static constexpr int kDof = 3 + count;
  static constexpr int kMultipliers = 1 + count;
  static constexpr bool kConstantMass = true;

  double trailer_weight = 0;

  template <class T>
  [[nodiscard]] Matrix<T, kDof, kDof> mass(const Vector<T, kDof>& /*q*/) const {
    Matrix<T, kDof, kDof> m = Matrix<T, kDof, kDof>::Zero();
    for (int i = 0; i < kDof; ++i) m(i, i) = i < 3 ? 1 : trailer_weight;
    return m;
  }

  template <class T>
  [[nodiscard]] Matrix<T, kMultipliers, kDof> constraints(const Vector<T, kDof>& q) const {
    using std::cos, std::sin;
    using G = Matrix<T, kMultipliers, kDof>;
    G g = G::Zero();
    for (int i = 0; i <= count; ++i) {
      g(i, 0) = sin(q[2 + i]);
      g(i, 1) = -cos(q[2 + i]);
      for (int j = 1; j < i; ++j) g(i, 2 + j) = cos(q[2 + i] - q[2 + j]);
      if (i > 0) g(i, 2 + i) = 1;
    }
    return g;
  }

  template <class T>
  [[nodiscard]] Matrix<T, kDof, 2> frame(const Vector<T, kDof>& q) const {
    using std::cos, std::sin;
    Matrix<T, kDof, 2> b = Matrix<T, kDof, 2>::Zero();
    b(0, 0) = cos(q[2]);
    b(1, 0) = sin(q[2]);
    b(2, 1) = 1;
    T speed = 1;
    for (int i = 1; i <= count; ++i) {
      b(2 + i, 0) = speed * sin(q[1 + i] - q[2 + i]);
      speed *= cos(q[1 + i] - q[2 + i]);
    }
    return b;
  }

  // The diagonal of B'M B.
  template <class T>
  [[nodiscard]] Vector<T, 2> frame_masses(const Vector<T, kDof>& q) const {
    Vector<T, 2> masses(1, 1);
    if (trailer_weight == 0) return masses;
    const Matrix<T, kDof, 2> b = frame(q);
    for (int i = 3; i < kDof; ++i) masses[0] += trailer_weight * b(i, 0) * b(i, 0);
    return masses;
  }

  // d/dq [p.B u - u'B'M B u/2]. What the car's heading and the hooks' angles d_i change: each d_i
  // turns trailer i and slows it, and with it all that follow, so the sum runs from the last one.
  template <class T>
  [[nodiscard]] Vector<T, kDof> frame_gradient(const Vector<T, kDof>& q,
                                               const Vector<T, kDof>& p,
                                               const Vector<T, 2>& u) const {
    using std::cos, std::sin;
    std::array<T, count> c;
    std::array<T, count> s;
    std::array<T, count> speed;  // v_i
    T v = u[0];
    for (int i = 0; i < count; ++i) {
      c[i] = cos(q[2 + i] - q[3 + i]);
      s[i] = sin(q[2 + i] - q[3 + i]);
      speed[i] = v;
      v *= c[i];
    }
    Vector<T, kDof> gradient = Vector<T, kDof>::Zero();
    gradient[2] = u[0] * (p[1] * cos(q[2]) - p[0] * sin(q[2]));
    T by_speed = 0;  // by v_i, of all behind axle i
    for (int i = count - 1; i >= 0; --i) {
      const T excess = p[3 + i] - trailer_weight * speed[i] * s[i];
      const T by_angle = speed[i] * (excess * c[i] - by_speed * s[i]);
      gradient[2 + i] += by_angle;
      gradient[3 + i] -= by_angle;
      by_speed = excess * s[i] + by_speed * c[i];
    }
    return gradient;
  }

  static constexpr auto parameters() {
    using P = Parameter<Trailers>;
    return std::array{P{"trailer_weight",
                        &Trailers::trailer_weight,
                        "length^2",
                        Range::non_negative(),
                        "inertia of each trailer, that of the car being 1"}};
  }

  [[nodiscard]] SceneInfo info() const {
    constexpr double kTurn = 2 * std::numbers::pi;
    SceneInfo info;
    info.name = "trailer" + std::to_string(count);
    info.summary = "a car that pulls " + std::to_string(count) + " trailer";
    info.summary += count == 1 ? "" : "s";
    info.reference =
        "Laumond, IEEE Trans. Robotics Automation 9 (1993); "
        "Fliess, Levine, Martin & Rouchon, Int. J. Control 61 (1995)";
    info.configuration = {{"x", "length", 0}, {"y", "length", 0}};
    std::vector<double> mirror = {1, -1};
    info.symmetries.x = 0;
    info.symmetries.y = 1;
    for (int i = 0; i <= count; ++i) {
      info.configuration.push_back({"t" + std::to_string(i), "rad", kTurn});
      info.symmetries.angles.push_back(2 + i);
      mirror.push_back(-1);
    }
    info.symmetries.mirrors = {mirror};
    info.drawing = {.view = Drawing::View::kPlane, .body = body};
    info.extremes = {{"largest_jackknife_angle", "rad", jackknife_angle}};
    return info;
  }

 private:
  // The largest angle at a hook.
  static double jackknife_angle(const double* q) {
    double largest = 0;
    for (int i = 3; i < kDof; ++i) largest = std::max(largest, std::abs(q[i - 1] - q[i]));
    return largest;
  }

  // A box and a wheel on each axle, and rods from axle to axle.
  static std::vector<Polyline> body(const double* q) {
    constexpr double kLength = 0.55;  // all as multiples of a rod
    constexpr double kWidth = 0.35;
    constexpr double kWheelRadius = 0.14;
    std::vector<Polyline> lines;
    double x = q[0];
    double y = q[1];
    for (int i = 2; i < kDof; ++i) {
      const double c = std::cos(q[i]);
      const double s = std::sin(q[i]);
      if (i > 2) {
        lines.push_back({Polyline::Role::kBody, {{x - c, y - s}, {x, y}}});
        x -= c;
        y -= s;
      }
      lines.push_back(rectangle({x, y}, q[i], kLength, kWidth));
      lines.push_back(wheel({x, y}, q[i], kWheelRadius));
    }
    return lines;
  }
};

}  // namespace carnot::scenes
