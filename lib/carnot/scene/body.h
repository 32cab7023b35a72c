// Parts of bodies, for the drawings of scenes.
//
// A body in the plane is a list of lines: a rectangle for a car, a wheel where it rolls, a globe
// for a ball. In space it is an arrow on a sphere. All lengths are in the units of the drawn axes,
// and all angles are in radians, counterclockwise from the first axis.
#pragma once

#include <array>
#include <vector>

#include "carnot/scene/scene_info.h"

namespace carnot {

// The axes of a body in space, one after the other: the columns of its rotation matrix.
using Attitude = std::array<std::array<double, 3>, 3>;

// R = Rz(psi) Ry(theta) Rx(phi), body to space.
Attitude attitude_of_angles(double psi, double theta, double phi);
// The rotation of the quaternion (w, x, y, z), body to space. Its norm does not matter, but it must
// not be zero.
Attitude attitude_of_quaternion(const double* q);

// A closed outline, `length` along the heading and `width` across, about its centre.
Polyline rectangle(const std::array<double, 2>& centre,
                   double heading,
                   double length,
                   double width);
// A wheel as seen from above, with its axle at `centre`.
Polyline wheel(const std::array<double, 2>& centre, double heading, double radius);

// A ball as seen from above: its outline, and what is visible of its equator, of the meridian from
// pole to pole through the body's x axis, and of two small circles, a larger one about the north
// pole, which is on the body's z axis, and a smaller one about the x axis. Together they show the
// attitude without doubt.
std::vector<Polyline> globe(const std::array<double, 2>& centre,
                            double radius,
                            const Attitude& attitude);

// An arrow of the given length on a sphere about the origin, from `place` along the tangent
// `direction`. `place` is on the sphere; both are not zero and orthogonal to each other.
std::vector<SpaceLine> arrow_on_sphere(const std::array<double, 3>& place,
                                       const std::array<double, 3>& direction,
                                       double length);

}  // namespace carnot
