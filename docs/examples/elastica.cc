// An optimal-control scene: a car of constant speed 1 that is steered with the least effort.
//
//   x' = cos theta,   y' = sin theta,   theta' = u,   cost u^2/2.
//
// u is the curvature of the path, so the paths are Euler's elastic curves: the shapes of a thin rod
// whose ends are clamped. The time is the length of the rod.
//
// The controls enter linearly: q' = drift(q) + frame(q) u, and the cost is u'R u/2 with R = I
// unless control_weight(q) says otherwise. A scene that is nonlinear in u writes
// dynamics(t, q, u) and running_cost(t, q, u) instead (lib/carnot/scenes/boat.h).
#include <carnot/make_dynamics.h>
#include <carnot/shooting/find_geodesics.h>

#include <cmath>
#include <iostream>
#include <numbers>

struct Elastica {
  static constexpr int kDof = 3;       // length of q
  static constexpr int kControls = 1;  // length of u

  template <class T>
  carnot::Vector<T, 3> drift(const carnot::Vector<T, 3>& q) const {
    using std::cos, std::sin;
    return {cos(q[2]), sin(q[2]), 0};
  }

  template <class T>
  carnot::Matrix<T, 3, 1> frame(const carnot::Vector<T, 3>& /*q*/) const {
    return {0, 0, 1};
  }

  carnot::SceneInfo info() const {
    carnot::SceneInfo info;
    info.name = "elastica";
    info.summary = "a car of constant speed that is steered with the least effort";
    info.configuration = {
        {"x", "length", 0}, {"y", "length", 0}, {"theta", "rad", 2 * std::numbers::pi}};
    return info;
  }
};

int main() {
  // A rod of length 2 from the origin, clamped along x, to (1, 1), clamped along y.
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(Elastica{}), {0, 0, 0}, {1, 1, std::numbers::pi / 2}, 2);
  const carnot::GeodesicReport report = carnot::find_geodesics(problem);
  if (report.geodesics.empty()) {
    std::cerr << report.message << '\n';
    return 1;
  }
  const carnot::Geodesic& best = report.geodesics.front();
  std::cout << "bending energy " << best.action << ", p0 (" << best.p0[0] << ", " << best.p0[1]
            << ", " << best.p0[2] << ")\n";
}
