// What is measured along a flow: action, length, energy, constraints.
#pragma once

#include <algorithm>
#include <cmath>

#include "carnot/flow/stage_measures.h"
#include "carnot/numerics/scalar.h"
#include "carnot/system/measures.h"

namespace carnot {

// Observer of flow(). The integrals use the method's own quadrature at its stages, so they have
// its order. L = p.q' - H on admissible velocities.
template <class Stepper>
class Monitor {
 public:
  using System = typename Stepper::System;
  static constexpr int n = Stepper::kDof;

  // Takes H at the first node as reference.
  Monitor(const System& system, double t, const Stepper& step, const State<double, n>& z)
      : system_(system), y_(step.branch()) {
    initial_ = node(t, z);
    energy_drift_ = energy_balance_ = 0;
  }

  void operator()(double t, const Stepper& step, const State<double, n>& z) {
    const double h = step.last_step();
    measure_stages(system_, step, [&](double b, const PointMeasures& at) {
      constraint_error_ = std::max(constraint_error_, at.constraint);
      if (b == 0) return;
      action_.add(h * b * at.lagrangian);
      // Substeps of a composition may go backwards: b_i < 0.
      length_.add(std::abs(h) * b * at.speed);
      work_.add(h * b * at.power);
    });
    y_ = step.branch();
    const double change = node(t, z) - initial_;
    raise(energy_drift_, std::abs(change));
    raise(energy_balance_, std::abs(change - work_.value));
  }

  [[nodiscard]] double action() const { return action_.value; }
  [[nodiscard]] double length() const { return length_.value; }
  // max |H - H_0| over the nodes.
  [[nodiscard]] double energy_drift() const { return energy_drift_; }
  // The integral of H_t so far.
  [[nodiscard]] double work() const { return work_.value; }
  // max |H - H_0 - integral of H_t|: the same for a system that does not depend on time.
  [[nodiscard]] double energy_balance() const { return energy_balance_; }
  // max |g(q, q')| / max(1, |q'|) over stages and nodes.
  [[nodiscard]] double constraint_error() const { return constraint_error_; }
  // max of |h(q)| and |Dh q'| / max(1, |q'|) over the nodes.
  [[nodiscard]] double holonomic_error() const { return holonomic_error_; }

 private:
  static void raise(double& largest, double value) { largest = maximum(largest, value); }

  // H at a node; its constraints are measured too.
  double node(double t, const State<double, n>& z) {
    NodeMeasures at;
    if constexpr (IsErased<System>) {
      at = system_.measure_node(t, z.value, y_);
    } else {
      at = measure_node<System>(
          system_, t, z.value.template head<n>(), z.value.template tail<n>(), y_);
    }
    constraint_error_ = std::max(constraint_error_, at.constraint);
    holonomic_error_ = std::max(holonomic_error_, at.holonomic);
    return at.hamiltonian;
  }

  const System& system_;
  Vector<double, System::kAlgebraic> y_;
  Compensated<double> action_{0, 0};
  Compensated<double> length_{0, 0};
  Compensated<double> work_{0, 0};
  double initial_ = 0;
  double energy_drift_ = 0;
  double energy_balance_ = 0;
  double constraint_error_ = 0;
  double holonomic_error_ = 0;
};

}  // namespace carnot
