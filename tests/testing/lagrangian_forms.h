// Scenes of the other kind, with linear constraints and quadratic L, written once more as L(t, q,
// v) and g(q, v): another route to the same flow.
#pragma once

#include <cmath>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/numerics/scalar.h"
#include "carnot/scenes/vehicle.h"

namespace carnot::test {

// scenes::Vehicle.
struct LagrangianVehicle {
  static constexpr int kDof = 4;
  static constexpr int kMultipliers = 2;

  scenes::Vehicle parameters;

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/,
                             const Vector<T, 4>& /*q*/,
                             const Vector<T, 4>& v) const {
    const T alpha = constant<T>(parameters.alpha);
    const T beta = constant<T>(parameters.beta);
    return constant<T>(0.5) *
           (v[0] * v[0] + v[1] * v[1] + alpha * v[2] * v[2] + beta * v[3] * v[3]);
  }
  template <class T>
  [[nodiscard]] Vector<T, 2> constraint(const Vector<T, 4>& q, const Vector<T, 4>& v) const {
    using std::cos, std::sin;
    const T sweep = constant<T>(parameters.length) * v[2];
    return {v[0] * sin(q[3]) - v[1] * cos(q[3]), v[0] * sin(q[2]) - v[1] * cos(q[2]) + sweep};
  }
};

// scenes::Heisenberg.
struct LagrangianHeisenberg {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/,
                             const Vector<T, 3>& /*q*/,
                             const Vector<T, 3>& v) const {
    return constant<T>(0.5) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  template <class T>
  [[nodiscard]] Vector<T, 1> constraint(const Vector<T, 3>& q, const Vector<T, 3>& v) const {
    return Vector<T, 1>(v[2] - q[1] * v[0] + q[0] * v[1]);
  }
};

// scenes::HeisenbergGroup: L does not contain z', so L_vv is singular.
struct LagrangianHeisenbergGroup {
  static constexpr int kDof = 3;
  static constexpr int kMultipliers = 1;

  template <class T>
  [[nodiscard]] T lagrangian(const T& /*t*/,
                             const Vector<T, 3>& /*q*/,
                             const Vector<T, 3>& v) const {
    return constant<T>(0.5) * (v[0] * v[0] + v[1] * v[1]);
  }
  template <class T>
  [[nodiscard]] Vector<T, 1> constraint(const Vector<T, 3>& q, const Vector<T, 3>& v) const {
    return Vector<T, 1>(v[2] + constant<T>(0.5) * (q[1] * v[0] - q[0] * v[1]));
  }
};

}  // namespace carnot::test
