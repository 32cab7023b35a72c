// What is measured along a flow: action, length, energy, constraints.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "carnot/step/runge_kutta.h"
#include "carnot/system/measures.h"

namespace carnot {

// Observer of flow(). The integrals use the method's own quadrature at its stages, so they have
// its order. L = p.q' - H on admissible velocities.
template <class Stepper>
class Monitor {
 public:
  using System = typename Stepper::System;
  using T = typename Stepper::Scalar;
  static constexpr int n = Stepper::kDof;

  // Takes H at the first node as reference.
  Monitor(const System& system, const T& t, const Stepper& step, const State<T, n>& z)
      : system_(system), y_(step.branch()) {
    initial_ = node(t, z);
    energy_drift_ = energy_balance_ = T(0);
  }

  void operator()(const T& t, const Stepper& step, const State<T, n>& z) {
    const T h = step.last_step();
    for (int i = 0; i < step.tableau().stages(); ++i) {
      const T weight = h * step.tableau().b[i];
      const Vector<T, n> q = step.stages().col(i).template head<n>();
      const Vector<T, n> p = step.stages().col(i).template tail<n>();
      const Vector<T, n> v =
          step.increments().col(i).template head<n>() / (h * step.tableau().omega[i]);
      constraint_error_ = std::max(constraint_error_, relative_constraint(q, v));
      if (weight == T(0)) continue;
      const T time = step.stage_time(i);
      const Vector<T, System::kAlgebraic> y = step.algebraic(i);
      action_.add(weight * (p.dot(v) - system_.hamiltonian(time, q, p, y)));
      // Substeps of a composition may go backwards: b_i < 0.
      length_.add(std::abs(h) * step.tableau().b[i] * system_.speed(q, v));
      if (!is_autonomous(system_)) power_.add(weight * explicit_rate(system_, time, q, p, y));
    }
    y_ = step.branch();
    const T change = node(t, z) - initial_;
    raise(energy_drift_, std::abs(change));
    raise(energy_balance_, std::abs(change - power_.value));
  }

  [[nodiscard]] T action() const { return action_.value; }
  [[nodiscard]] T length() const { return length_.value; }
  // max |H - H_0| over the nodes.
  [[nodiscard]] T energy_drift() const { return energy_drift_; }
  // max |H - H_0 - integral of H_t|: the same for a system that does not depend on time.
  [[nodiscard]] T energy_balance() const { return energy_balance_; }
  // max |g(q, q')| / max(1, |q'|) over stages and nodes.
  [[nodiscard]] T constraint_error() const { return constraint_error_; }
  // max of |h(q)| and |Dh q'| / max(1, |q'|) over the nodes.
  [[nodiscard]] T holonomic_error() const { return holonomic_error_; }

 private:
  static void raise(T& largest, const T& value) {
    if (!(value <= largest)) largest = value;  // a NaN stays
  }

  // H at a node; its constraints are measured too.
  T node(const T& t, const State<T, n>& z) {
    const Vector<T, n> q = z.value.template head<n>();
    const Vector<T, n> p = z.value.template tail<n>();
    Rate<T, n> rate;
    if (system_.rate(t, q, p, y_, rate) != RateStatus::kOk) {
      return std::numeric_limits<T>::quiet_NaN();
    }
    constraint_error_ = std::max(constraint_error_, relative_constraint(q, rate.q_dot));
    holonomic_error_ = std::max(holonomic_error_, carnot::holonomic_error(system_, q, rate.q_dot));
    return system_.hamiltonian(t, q, p, y_);
  }

  T relative_constraint(const Vector<T, n>& q, const Vector<T, n>& v) const {
    return constraint_norm(system_, q, v) / std::max(T(1), v.cwiseAbs().maxCoeff());
  }

  const System& system_;
  Vector<T, System::kAlgebraic> y_;
  Compensated<T> action_{T(0), T(0)};
  Compensated<T> length_{T(0), T(0)};
  Compensated<T> power_{T(0), T(0)};
  T initial_ = T(0);
  T energy_drift_ = T(0);
  T energy_balance_ = T(0);
  T constraint_error_ = T(0);
  T holonomic_error_ = T(0);
};

}  // namespace carnot
