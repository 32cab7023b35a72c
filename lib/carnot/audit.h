// What is measured along a flow: action, length, energy drift, constraint error.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/gauss.h"

namespace carnot {

// Observer of flow(). The integrals use the method's own quadrature at its stages, so they have
// its order. L = p.q' - H on admissible velocities.
template <class Stepper>
class Audit {
 public:
  using System = typename Stepper::System;
  using T = typename Stepper::Scalar;
  static constexpr int n = Stepper::kDof;

  // Takes H at the first node as reference.
  Audit(const System& system, const T& t, const State<T, n>& z) : system_(system) {
    y_.setZero();
    initial_ = node(t, z);
    energy_drift_ = T(0);
  }

  void operator()(const T& t, const Stepper& step, const State<T, n>& z) {
    const T h = step.last_step();
    for (int i = 0; i < Stepper::kStages; ++i) {
      const T weight = h * step.tableau().b[i];
      const Vector<T, n> q = step.stages().col(i).template head<n>();
      const Vector<T, n> p = step.stages().col(i).template tail<n>();
      const Vector<T, n> v = step.increments().col(i).template head<n>() / weight;
      const T hamiltonian = system_.hamiltonian(step.stage_time(i), q, p, step.algebraic(i));
      action_.add(weight * (p.dot(v) - hamiltonian));
      length_.add(std::abs(weight) * system_.speed(q, v));
      constraint_error_ = std::max(constraint_error_, relative_constraint(q, v));
    }
    const T drift = std::abs(node(t, z) - initial_);
    if (!(drift <= energy_drift_)) energy_drift_ = drift;  // a NaN stays
  }

  [[nodiscard]] T action() const { return action_.value; }
  [[nodiscard]] T length() const { return length_.value; }
  [[nodiscard]] T energy_drift() const { return energy_drift_; }
  [[nodiscard]] T constraint_error() const { return constraint_error_; }

 private:
  // H at a node; its constraint is measured too.
  T node(const T& t, const State<T, n>& z) {
    const Vector<T, n> q = z.value.template head<n>();
    const Vector<T, n> p = z.value.template tail<n>();
    Rate<T, n> rate;
    if (system_.rate(t, q, p, y_, rate) != RateStatus::kOk) {
      return std::numeric_limits<T>::quiet_NaN();
    }
    constraint_error_ = std::max(constraint_error_, relative_constraint(q, rate.q_dot));
    return system_.hamiltonian(t, q, p, y_);
  }

  T relative_constraint(const Vector<T, n>& q, const Vector<T, n>& v) const {
    const Vector<T, System::kMultipliers> g = system_.constraint(q, v);
    const T size = std::max(T(1), v.cwiseAbs().maxCoeff());
    return System::kMultipliers == 0 ? T(0) : g.norm() / size;
  }

  const System& system_;
  Vector<T, System::kAlgebraic> y_;
  Compensated<T> action_{T(0), T(0)};
  Compensated<T> length_{T(0), T(0)};
  T initial_ = T(0);
  T energy_drift_ = T(0);
  T constraint_error_ = T(0);
};

}  // namespace carnot
