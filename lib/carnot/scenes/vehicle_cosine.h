// The vehicle on a bumpy surface, V = -cos r (McLachlan et al. 2013, section 5).
//
// r is the distance of the vehicle's midpoint (x - l/2 cos theta, y - l/2 sin theta) from the
// origin. V is a function of r^2 (stumpff.h) and so is smooth at r = 0 too. Invariants: H, and
// x p_y - y p_x + p_theta + p_phi, for V is symmetric under rotations about the origin.
#pragma once

#include "carnot/numerics/stumpff.h"
#include "carnot/scenes/vehicle.h"

namespace carnot::scenes {

struct VehicleCosine : Vehicle {
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 4>& q) const {
    const Vector<T, 2> m = midpoint(q);
    return -stumpff<0>(T(m[0] * m[0] + m[1] * m[1]));
  }

  // The vehicle's own gradient and grad V = sin(r)/r m . dm/dq.
  template <class T>
  [[nodiscard]] Vector<T, 4> frame_gradient(const Vector<T, 4>& q,
                                            const Vector<T, 4>& p,
                                            const Vector<T, 2>& u) const {
    const Vector<T, 2> m = midpoint(q);
    const T slope = stumpff<1>(T(m[0] * m[0] + m[1] * m[1]));
    const double half = 0.5 * length;
    Vector<T, 4> gradient = Vehicle::frame_gradient(q, p, u);
    gradient[0] += slope * m[0];
    gradient[1] += slope * m[1];
    const Vector<T, 2> body = heading(q);
    gradient[2] += slope * half * (m[0] * body[1] - m[1] * body[0]);
    return gradient;
  }

  [[nodiscard]] SceneInfo info() const {
    SceneInfo info = Vehicle::info();
    info.name = "vehicle-cosine";
    info.summary = "the vehicle in the potential V = -cos r of its midpoint";
    info.symmetries.x = info.symmetries.y = -1;  // V is not the same everywhere
    info.symmetries.angles.clear();
    return info;
  }

 private:
  template <class T>
  [[nodiscard]] Vector<T, 2> midpoint(const Vector<T, 4>& q) const {
    const double half = 0.5 * length;
    const Vector<T, 2> body = heading(q);
    return {q[0] - half * body[0], q[1] - half * body[1]};
  }
  // (cos theta, sin theta) by phi and phi - theta, which the frame asks for too.
  template <class T>
  [[nodiscard]] static Vector<T, 2> heading(const Vector<T, 4>& q) {
    using std::cos, std::sin;
    const T delta = q[3] - q[2];
    const Vector<T, 2> phi(cos(q[3]), sin(q[3]));
    const Vector<T, 2> turn(cos(delta), sin(delta));
    return {phi[0] * turn[0] + phi[1] * turn[1], phi[1] * turn[0] - phi[0] * turn[1]};
  }
};

}  // namespace carnot::scenes
