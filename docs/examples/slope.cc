// A scene with velocity constraints: an ice skate on a slope.
//
// The skate touches the ice at (x, y), it points along theta and cannot slip sideways,
//
//   x' sin theta - y' cos theta = 0.
//
// It has the mass 1 and the moment of inertia `inertia`, and the slope falls along x:
//
//   L = (x'^2 + y'^2 + inertia theta'^2)/2 - V,   V = -gravity x.
//
// So M = diag(1, 1, inertia) and G = (sin theta, -cos theta, 0).
#include <carnot/make_dynamics.h>
#include <carnot/shooting/find_geodesics.h>

#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

struct Skate {
  static constexpr int kDof = 3;          // length of q
  static constexpr int kMultipliers = 1;  // rows of G

  double inertia = 1;
  double gravity = 0.5;

  template <class T>
  carnot::Matrix<T, 3, 3> mass(const carnot::Vector<T, 3>& /*q*/) const {
    return carnot::diagonal<T>(1, 1, inertia);
  }

  template <class T>
  carnot::Matrix<T, 1, 3> constraints(const carnot::Vector<T, 3>& q) const {
    using std::cos, std::sin;
    return {sin(q[2]), -cos(q[2]), 0};
  }

  // What follows is optional. V is zero where a scene has no potential.
  template <class T>
  T potential(const carnot::Vector<T, 3>& q) const {
    return -gravity * q[0];
  }

  // The columns span the admissible velocities, G B = 0: gliding and turning. With a frame no
  // multipliers are needed on the way, so that every step is cheaper.
  template <class T>
  carnot::Matrix<T, 3, 2> frame(const carnot::Vector<T, 3>& q) const {
    using std::cos, std::sin;
    carnot::Matrix<T, 3, 2> b;
    b << cos(q[2]), 0, sin(q[2]), 0, 0, 1;
    return b;
  }

  // The diagonal of B'M B, for a frame whose columns are orthogonal under M.
  template <class T>
  carnot::Vector<T, 2> frame_masses(const carnot::Vector<T, 3>& /*q*/) const {
    return {1, inertia};
  }

  // make_dynamics() refuses values that are out of these ranges, and names the parameter.
  static constexpr auto parameters() {
    using P = carnot::Parameter<Skate>;
    return std::array{
        P{"inertia",
          &Skate::inertia,
          "length^2",
          carnot::Range::positive(),
          "moment of inertia about the point of contact, per unit mass"},
        P{"gravity", &Skate::gravity, "length/time^2", carnot::Range{}, "acceleration along x"}};
  }

  // Names and units, the period of an angle, the symmetries, and how a picture shows the body.
  carnot::SceneInfo info() const {
    carnot::SceneInfo info;
    info.name = "skate";
    info.summary = "an ice skate on a slope that falls along x";
    info.configuration = {
        {"x", "length", 0}, {"y", "length", 0}, {"theta", "rad", 2 * std::numbers::pi}};
    info.symmetries.mirrors = {{1, -1, -1}};  // y -> -y and theta -> -theta leave H as it is
    info.symmetries.cyclic = {1};             // H does not depend on y
    info.drawing = {
        carnot::Drawing::View::kPlane, {0, 1, 2}, [](const double* q) {
          const double dx = 0.1 * std::cos(q[2]);
          const double dy = 0.1 * std::sin(q[2]);
          return std::vector<carnot::Polyline>{
              {carnot::Polyline::Role::kWheel, {{q[0] - dx, q[1] - dy}, {q[0] + dx, q[1] + dy}}}};
        }};
    return info;
  }
};

int main() {
  // From the top, heading down the slope, to a point below and beside it.
  const carnot::BoundaryValueProblem problem(
      carnot::make_dynamics(Skate{}), {0, 0, 0}, {1, 0.5, 0.2});
  const carnot::GeodesicReport report = carnot::find_geodesics(problem);
  if (report.geodesics.empty()) {
    std::cerr << report.message << '\n';
    return 1;
  }
  const carnot::Geodesic& best = report.geodesics.front();
  std::cout << "action " << best.action << ", p0 (" << best.p0[0] << ", " << best.p0[1] << ", "
            << best.p0[2] << ")\n";
}
