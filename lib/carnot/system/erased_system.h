// A system of which the compiler knows the number of coordinates only.
//
// The integrators ask a system for rates and little else, so that one kernel for each number of
// coordinates serves all scenes: it reaches them through the function pointers below, one call for
// the whole iteration on the stages of a step, and one for what is measured at them. The kernels
// are compiled once (flow/make_kernel.h), and a scene compiles no more than its own formulas
// (system_calls.h). Against a kernel that knows its scene, flows by gauss16 were measured to take
// 0.99 to 1.07 times as long, and tangent flows 1.04 to 1.07 times (carnot_micro, three scenes,
// Sapphire Rapids).
#pragma once

#include <algorithm>
#include <cmath>

#include "carnot/system/index_one_system.h"
#include "carnot/system/system_functions.h"

namespace carnot {

// A model of IndexOneSystem for n coordinates. y and lambda have room for 2n numbers; those that
// the system does not use stay zero. Copies are cheap; the system must outlive them.
template <int n>
class ErasedSystem {
 public:
  static constexpr bool kErased = true;
  static constexpr int kDof = n;
  static constexpr int kAlgebraic = kMostAlgebraic * n;
  static constexpr int kMultipliers = kMostAlgebraic * n;
  static constexpr bool kAutonomous = false;  // it may be; the kernels do not ask
  static constexpr bool kPacks = true;
  using Configuration = Vector<double, n>;
  using Point = Vector<double, 2 * n>;
  using Square = Matrix<double, 2 * n, 2 * n>;
  using Algebraic = Vector<double, kAlgebraic>;

  ErasedSystem(const void* system, const SystemFunctions& functions)
      : system_(system), functions_(&functions) {}

  [[nodiscard]] int algebraic_count() const { return functions_->algebraic; }
  [[nodiscard]] int multiplier_count() const { return functions_->multipliers; }
  // The solution y that a run begins with.
  [[nodiscard]] Algebraic branch() const {
    Algebraic y;
    std::fill_n(y.data(), kAlgebraic, 0.0);
    functions_->branch(system_, y.data());
    return y;
  }

  [[nodiscard]] RateStatus phase_rate(double t, const Point& z, Algebraic& y, Point& z_dot) const {
    return functions_->rate(system_, t, z.data(), y.data(), z_dot.data());
  }
  [[nodiscard]] RateStatus phase_jacobian(double t,
                                          const Point& z,
                                          const Algebraic& y,
                                          Square& jacobian) const {
    return functions_->jacobian(system_, t, z.data(), y.data(), jacobian.data());
  }
  template <int W>
  [[nodiscard]] bool packed_rate(const double* t, const double* z, double* y, double* z_dot) const {
    static_assert(W == kErasedLanes);
    return functions_->rates(system_, t, z, y, z_dot);
  }
  [[nodiscard]] bool packed_jacobian(const double* t,
                                     const double* z,
                                     const double* weights,
                                     double* jacobian) const {
    return functions_->jacobians(system_, t, z, weights, jacobian);
  }
  [[nodiscard]] StageReport packed_iteration(const StageData& data,
                                             const IterationLimits<double>& limits) const {
    return functions_->iterate(system_, data, limits);
  }

  [[nodiscard]] RateStatus rate(double t,
                                const Configuration& q,
                                const Configuration& p,
                                Algebraic& y,
                                Rate<double, n>& out) const {
    Point z;
    std::copy_n(q.data(), n, z.data());
    std::copy_n(p.data(), n, z.data() + n);
    Point z_dot;
    const RateStatus status = phase_rate(t, z, y, z_dot);
    if (status != RateStatus::kOk) return status;
    std::copy_n(z_dot.data(), n, out.q_dot.data());
    std::copy_n(z_dot.data() + n, n, out.p_dot.data());
    return status;
  }
  [[nodiscard]] double hamiltonian(double t,
                                   const Configuration& q,
                                   const Configuration& p,
                                   const Algebraic& y) const {
    return functions_->hamiltonian(system_, t, q.data(), p.data(), y.data());
  }
  [[nodiscard]] RateStatus multipliers(double t,
                                       const Configuration& q,
                                       const Configuration& p,
                                       const Algebraic& y,
                                       Vector<double, kMultipliers>& lambda) const {
    return functions_->find_multipliers(system_, t, q.data(), p.data(), y.data(), lambda.data());
  }
  void measure(int count,
               const double* t,
               const double* weights,
               const double* z,
               const double* dq,
               const double* y,
               PointMeasures* out) const {
    functions_->measure(system_, count, t, weights, z, dq, y, out);
  }
  [[nodiscard]] NodeMeasures measure_node(double t, const Point& z, Algebraic& y) const {
    return functions_->measure_node(system_, t, z.data(), y.data());
  }

 private:
  const void* system_;
  const SystemFunctions* functions_;
};

}  // namespace carnot
