// Boundary-value problems with drift, of scenes from text.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "carnot/load_scene.h"
#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::test {

inline Dynamics literature(const std::string& name) {
  return make_dynamics(load_scene(CARNOT_SOURCE_DIR "/docs/examples/scenes/" + name + ".scene"));
}
inline Dynamics from_text(const std::string& text) { return make_dynamics(scene_from_text(text)); }

// x'' = u at the cost u^2 / 2.
inline Dynamics double_integrator() {
  return from_text("coordinates x, v\ncontrols u\nx' = v\nv' = u\ncost = u^2 / 2\n");
}
// From (1, 0) to rest at zero.
inline BoundaryValueProblem regulator(double time) {
  return {literature("regulator"), {1, 0}, {0, 0}, time};
}
inline BoundaryValueProblem swing_up() {
  return {literature("pendulum-swing-up"), {0, 0}, {std::numbers::pi, 0}, 8};
}
inline BoundaryValueProblem cart_pole() {
  return {literature("cart-pole"), {0, 0, 0, 0}, {0, std::numbers::pi, 0, 0}, 2};
}
// From a circle to a larger one, on the other side of the planet.
inline BoundaryValueProblem kepler(double time) {
  return {literature("kepler-transfer"), {1, 0, 0, 1}, {-1.5, 0, 0, -1 / std::sqrt(1.5)}, time};
}
inline BoundaryValueProblem van_der_pol(double time) {
  return {literature("van-der-pol"), {1, 0}, {0, 0}, time};
}

}  // namespace carnot::test
