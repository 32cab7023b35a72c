// What is measured along a flow: action, length, energy, constraints.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/step/runge_kutta.h"
#include "carnot/system/measures.h"

namespace carnot {

// Its stages lie in rows of kErasedLanes.
template <class Stepper>
concept HasRows = Stepper::kRows;

// Observer of flow(). The integrals use the method's own quadrature at its stages, so they have
// its order. L = p.q' - H on admissible velocities.
template <class Stepper>
class Monitor {
 public:
  using System = typename Stepper::System;
  static constexpr int n = Stepper::kDof;
  static constexpr int m = System::kAlgebraic;

  // Takes H at the first node as reference.
  Monitor(const System& system, double t, const Stepper& step, const State<double, n>& z)
      : system_(system), y_(step.branch()) {
    initial_ = node(t, z);
    energy_drift_ = energy_balance_ = 0;
  }

  void operator()(double t, const Stepper& step, const State<double, n>& z) {
    const double h = step.last_step();
    const auto& tableau = step.tableau();
    for (int first = 0; first < tableau.stages(); first += kTogether) {
      const int count = std::min(kTogether, tableau.stages() - first);
      measure(step, first, count);
      for (int l = 0; l < count; ++l) {
        const PointMeasures& at = measures_[l];
        const double b = tableau.b[first + l];
        constraint_error_ = std::max(constraint_error_, at.constraint);
        if (b == 0) continue;
        action_.add(h * b * at.lagrangian);
        // Substeps of a composition may go backwards: b_i < 0.
        length_.add(std::abs(h) * b * at.speed);
        power_.add(h * b * at.power);
      }
    }
    y_ = step.branch();
    const double change = node(t, z) - initial_;
    raise(energy_drift_, std::abs(change));
    raise(energy_balance_, std::abs(change - power_.value));
  }

  [[nodiscard]] double action() const { return action_.value; }
  [[nodiscard]] double length() const { return length_.value; }
  // max |H - H_0| over the nodes.
  [[nodiscard]] double energy_drift() const { return energy_drift_; }
  // max |H - H_0 - integral of H_t|: the same for a system that does not depend on time.
  [[nodiscard]] double energy_balance() const { return energy_balance_; }
  // max |g(q, q')| / max(1, |q'|) over stages and nodes.
  [[nodiscard]] double constraint_error() const { return constraint_error_; }
  // max of |h(q)| and |Dh q'| / max(1, |q'|) over the nodes.
  [[nodiscard]] double holonomic_error() const { return holonomic_error_; }

 private:
  static void raise(double& largest, double value) {
    if (!(value <= largest)) largest = value;  // a NaN stays
  }

  static constexpr int kTogether = kErasedLanes;

  // Stages first, ..., first + count - 1.
  void measure(const Stepper& step, int first, int count) {
    std::array<double, kTogether> time;
    std::array<double, kTogether> weights;
    for (int l = 0; l < count; ++l) {
      time[l] = step.stage_time(first + l);
      weights[l] = step.last_step() * step.tableau().omega[first + l];
    }
    const auto at = [&](const double* z, const double* dq, const double* y) {
      measure_points(system_, count, time.data(), weights.data(), z, dq, y, measures_.data());
    };
    if constexpr (HasRows<Stepper>) {
      at(step.stages().data(), step.increments().data(), step.algebraic().data());
    } else {
      std::array<double, kTogether * 2 * n> z;
      std::array<double, kTogether * n> dq;
      std::array<double, kTogether * m> y;
      int used = m;
      if constexpr (IsErased<System>) used = system_.algebraic_count();
      for (int l = 0; l < count; ++l) {
        for (int k = 0; k < 2 * n; ++k) z[k * kTogether + l] = step.stages()(k, first + l);
        for (int k = 0; k < n; ++k) dq[k * kTogether + l] = step.increments()(k, first + l);
        const Vector<double, m> solution = step.algebraic(first + l);
        for (int k = 0; k < used; ++k) y[k * kTogether + l] = solution[k];
      }
      at(z.data(), dq.data(), y.data());
    }
  }

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
  Vector<double, m> y_;
  std::array<PointMeasures, kTogether> measures_;
  Compensated<double> action_{0, 0};
  Compensated<double> length_{0, 0};
  Compensated<double> power_{0, 0};
  double initial_ = 0;
  double energy_drift_ = 0;
  double energy_balance_ = 0;
  double constraint_error_ = 0;
  double holonomic_error_ = 0;
};

}  // namespace carnot
