// What is measured of a system at a point of its motion.
#pragma once

#include <algorithm>
#include <limits>

#include "carnot/numerics/gradient.h"
#include "carnot/system/holonomic.h"
#include "carnot/system/index_one_system.h"
#include "carnot/system/system_functions.h"

namespace carnot {

// How many multipliers there are.
template <class System>
int multiplier_count(const System& system) {
  if constexpr (IsErased<System>) {
    return system.multiplier_count();
  } else {
    return System::kMultipliers;
  }
}

// H_t at fixed q, p, y: the rate of change of H along the exact flow.
template <class System, class T>
T explicit_rate(const System& system,
                const T& t,
                const Vector<T, System::kDof>& q,
                const Vector<T, System::kDof>& p,
                const Vector<T, System::kAlgebraic>& y) {
  if constexpr (System::kAutonomous) {
    return T(0);
  } else {
    using J = Jet<T, 1>;
    return system.hamiltonian(J(t, 0), unseeded<J>(q), unseeded<J>(p), unseeded<J>(y)).v[0];
  }
}

// |g(q, v)| / max(1, |v|), with the largest entry as |v|.
template <class System, class T, int n>
T relative_constraint(const System& system, const Vector<T, n>& q, const Vector<T, n>& v) {
  if constexpr (System::kMultipliers == 0) {
    return T(0);
  } else {
    const Vector<T, System::kMultipliers> g = system.constraint(q, v);
    return g.norm() / std::max(T(1), largest_entry(v));
  }
}

// max of |h(q)| and |Dh v| / max(1, |v|); 0 where there are no holonomic constraints.
template <class System, class T, int n>
T holonomic_error(const System& system, const Vector<T, n>& q, const Vector<T, n>& v) {
  if constexpr (HolonomicSystem<System>) {
    const T size = std::max(T(1), largest_entry(v));
    const T hidden = hidden_residual(system.scene(), q, v) / size;
    return std::max(holonomic_residual(system.scene(), q), hidden);
  } else {
    return T(0);
  }
}

// At the first `count` points of rows of kErasedLanes, with velocities dq / weights.
template <class System>
void measure_points(const System& system,
                    int count,
                    const double* t,
                    const double* weights,
                    const double* z,
                    const double* dq,
                    const double* y,
                    PointMeasures* out) {
  if constexpr (IsErased<System>) {
    system.measure(count, t, weights, z, dq, y, out);
  } else {
    constexpr int n = System::kDof;
    constexpr int s = kErasedLanes;
    for (int l = 0; l < count; ++l) {
      Vector<double, n> q;
      Vector<double, n> p;
      Vector<double, n> v;
      Vector<double, System::kAlgebraic> algebraic;
      for (int k = 0; k < n; ++k) {
        q[k] = z[k * s + l];
        p[k] = z[(n + k) * s + l];
        v[k] = dq[k * s + l] / weights[l];
      }
      for (int k = 0; k < System::kAlgebraic; ++k) algebraic[k] = y[k * s + l];
      out[l].lagrangian = p.dot(v) - system.hamiltonian(t[l], q, p, algebraic);
      out[l].speed = system.speed(q, v);
      out[l].power = explicit_rate(system, t[l], q, p, algebraic);
      out[l].constraint = relative_constraint(system, q, v);
    }
  }
}

// At a node; y is the warm start, and the solution afterwards.
template <class System>
NodeMeasures measure_node(const System& system,
                          double t,
                          const Vector<double, System::kDof>& q,
                          const Vector<double, System::kDof>& p,
                          Vector<double, System::kAlgebraic>& y) {
  NodeMeasures out;
  Rate<double, System::kDof> rate;
  if (system.rate(t, q, p, y, rate) != RateStatus::kOk) {
    out.hamiltonian = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  out.constraint = relative_constraint(system, q, rate.q_dot);
  out.holonomic = holonomic_error(system, q, rate.q_dot);
  out.hamiltonian = system.hamiltonian(t, q, p, y);
  return out;
}

}  // namespace carnot
