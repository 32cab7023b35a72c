#include "shooting/problems.h"

#include <utility>

#include "carnot/make_segment.h"
#include "carnot/scenes/heisenberg_group.h"
#include "carnot/scenes/unicycle.h"
#include "carnot/scenes/vehicle.h"
#include "carnot/scenes/vehicle_cosine.h"

namespace carnot::test {
namespace {

struct Oscillator {
  static constexpr int kDof = 2;
  static constexpr int kMultipliers = 0;

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

}  // namespace

BoundaryValueProblem vehicle(std::vector<double> from, std::vector<double> to, double time) {
  return {make_segment(scenes::Vehicle{}), std::move(from), std::move(to), time};
}

BoundaryValueProblem sideways() { return vehicle({0, 0, 0, 0}, {0, 1, 0, 0}); }

BoundaryValueProblem straight_ahead() { return vehicle({0, 0, 0, 0}, {1, 0, 0, 0}); }

BoundaryValueProblem long_vehicle(std::vector<double> from, std::vector<double> to, double length) {
  scenes::Vehicle scene;
  scene.length = length;
  return {make_segment(scene), std::move(from), std::move(to)};
}

BoundaryValueProblem stiff_vehicle(std::vector<double> to) {
  scenes::Vehicle scene;
  scene.alpha = 0.1;
  scene.beta = 0.02;
  scene.length = 2.5;
  return {make_segment(scene), {0, 0, 0, 0}, std::move(to)};
}

BoundaryValueProblem vehicle_cosine(std::vector<double> from, std::vector<double> to, double time) {
  return {make_segment(scenes::VehicleCosine{}), std::move(from), std::move(to), time};
}

BoundaryValueProblem heisenberg_group(std::vector<double> to, double time) {
  return {make_segment(scenes::HeisenbergGroup{}), {0, 0, 0}, std::move(to), time};
}

BoundaryValueProblem unicycle(std::vector<double> from, std::vector<double> to) {
  return {make_segment(scenes::Unicycle{}), std::move(from), std::move(to)};
}

BoundaryValueProblem oscillator(std::vector<double> from, std::vector<double> to, double time) {
  return {make_segment(Oscillator{}), std::move(from), std::move(to), time};
}

Segment vehicle_midpoint() { return make_segment(scenes::Vehicle{}, "midpoint"); }

}  // namespace carnot::test
