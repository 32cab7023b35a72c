#include "shooting/problems.h"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "carnot/load_scene.h"
#include "carnot/make_dynamics.h"
#include "catalogue/scene_choice.h"

namespace carnot::test {
namespace {

// Number by number: the way of scenes that do not run on packs, and quick to compile.
struct Oscillator {
  static constexpr int kDof = 2;
  static constexpr int kMultipliers = 0;
  static constexpr bool kScalarOnly = true;

  template <class T>
  [[nodiscard]] Matrix<T, 2, 2> mass(const Vector<T, 2>& /*q*/) const {
    Matrix<T, 2, 2> m = Matrix<T, 2, 2>::Constant(constant<T>(0));
    m(0, 0) = m(1, 1) = constant<T>(1);
    return m;
  }
  template <class T>
  [[nodiscard]] Matrix<T, 0, 2> constraints(const Vector<T, 2>& /*q*/) const {
    return {};
  }
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 2>& q) const {
    return constant<T>(0.5) * (q[0] * q[0] + q[1] * q[1]);
  }
};

struct Pendulum {
  static constexpr int kDof = 1;
  static constexpr int kMultipliers = 0;
  static constexpr bool kScalarOnly = true;

  template <class T>
  [[nodiscard]] Matrix<T, 1, 1> mass(const Vector<T, 1>& /*q*/) const {
    return Matrix<T, 1, 1>::Constant(constant<T>(1));
  }
  template <class T>
  [[nodiscard]] Matrix<T, 0, 1> constraints(const Vector<T, 1>& /*q*/) const {
    return {};
  }
  template <class T>
  [[nodiscard]] T potential(const Vector<T, 1>& q) const {
    using std::cos;
    return -cos(q[0]);
  }
};

Dynamics dynamics(std::string_view scene,
                  const apps::ParameterValues& parameters = {},
                  std::string_view method = default_method<Oscillator>()) {
  return apps::find_scene(scene).make(parameters, std::string(method));
}

}  // namespace

BoundaryValueProblem vehicle(std::vector<double> from, std::vector<double> to, double time) {
  return {dynamics("vehicle"), std::move(from), std::move(to), time};
}

BoundaryValueProblem sideways() { return vehicle({0, 0, 0, 0}, {0, 1, 0, 0}); }

BoundaryValueProblem straight_ahead() { return vehicle({0, 0, 0, 0}, {1, 0, 0, 0}); }

BoundaryValueProblem long_vehicle(std::vector<double> from, std::vector<double> to, double length) {
  return {dynamics("vehicle", {{"length", length}}), std::move(from), std::move(to)};
}

BoundaryValueProblem stiff_vehicle(std::vector<double> to) {
  const apps::ParameterValues stiff = {{"alpha", 0.1}, {"beta", 0.02}, {"length", 2.5}};
  return {dynamics("vehicle", stiff), {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem light_steering(std::vector<double> to, double beta) {
  return {dynamics("vehicle", {{"beta", beta}}), {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem light_car(std::vector<double> to) {
  const Dynamics car = make_dynamics(scene_from_text(R"(
    coordinates x, y [length], theta, phi [angle]
    kinetic = (x'^2 + y'^2 + 0.05 theta'^2 + 0.002 phi'^2) / 2
    0 = x' sin(theta) - y' cos(theta)
    0 = 2.7 theta' cos(phi) - (x' cos(theta) + y' sin(theta)) sin(phi)
  )"));
  return {car, {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem vehicle_cosine(std::vector<double> from, std::vector<double> to, double time) {
  return {dynamics("vehicle-cosine"), std::move(from), std::move(to), time};
}

BoundaryValueProblem heisenberg_group(std::vector<double> to, double time) {
  return {dynamics("heisenberg-group"), {0, 0, 0}, std::move(to), time};
}

BoundaryValueProblem martinet(std::vector<double> to) {
  return {dynamics("martinet"), {0, 0, 0}, std::move(to)};
}

BoundaryValueProblem engel(std::vector<double> to) {
  return {dynamics("engel"), {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem falling_cat(std::vector<double> to) {
  return {dynamics("falling-cat"), {0, 0, 0}, std::move(to)};
}

BoundaryValueProblem unicycle(std::vector<double> from, std::vector<double> to) {
  return {dynamics("unicycle"), std::move(from), std::move(to)};
}

BoundaryValueProblem grushin(std::vector<double> from, std::vector<double> to) {
  return {dynamics("grushin"), std::move(from), std::move(to)};
}

BoundaryValueProblem bicycle(std::vector<double> to) {
  return {dynamics("bicycle"), {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem satellite(std::vector<double> to) {
  return {dynamics("satellite"), {0, 0, 0}, std::move(to)};
}

BoundaryValueProblem satellite_quaternion(std::vector<double> to) {
  return {dynamics("satellite-quaternion"), {1, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem plate_ball_quaternion(std::vector<double> to) {
  return {dynamics("plate-ball-quaternion"), {0, 0, 1, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem oscillator(std::vector<double> from, std::vector<double> to, double time) {
  return {make_dynamics(Oscillator{}), std::move(from), std::move(to), time};
}

BoundaryValueProblem pendulum(double from, double to, double time) {
  return {make_dynamics(Pendulum{}), {from}, {to}, time};
}

Dynamics vehicle_in_units(double lengths) {
  const double squared = lengths * lengths;
  return dynamics("vehicle", {{"length", lengths}, {"alpha", squared}, {"beta", squared}});
}

Dynamics vehicle_with_alpha(double alpha) { return dynamics("vehicle", {{"alpha", alpha}}); }

Dynamics vehicle_midpoint() { return dynamics("vehicle", {}, "midpoint"); }

Dynamics rod_skate_rattle() { return dynamics("rod-skate", {}, "rattle"); }

}  // namespace carnot::test
