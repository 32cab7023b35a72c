// What is measured of a system at a point of its motion.
#pragma once

#include <algorithm>

#include "carnot/numerics/gradient.h"
#include "carnot/system/holonomic.h"
#include "carnot/system/index_one_system.h"

namespace carnot {

// Whether H does not depend on time.
template <class System>
bool is_autonomous(const System& system) {
  if constexpr (IsErased<System>) {
    return system.autonomous();
  } else {
    return System::kAutonomous;
  }
}

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
  if constexpr (IsErased<System>) {
    return system.explicit_rate(t, q, p, y);
  } else if constexpr (System::kAutonomous) {
    return T(0);
  } else {
    using J = Jet<T, 1>;
    return system.hamiltonian(J(t, 0), unseeded<J>(q), unseeded<J>(p), unseeded<J>(y)).v[0];
  }
}

// |g(q, v)|.
template <class System, class T, int n>
T constraint_norm(const System& system, const Vector<T, n>& q, const Vector<T, n>& v) {
  if constexpr (IsErased<System>) {
    return system.constraint_norm(q, v);
  } else if constexpr (System::kMultipliers == 0) {
    return T(0);
  } else {
    const Vector<T, System::kMultipliers> g = system.constraint(q, v);
    return g.norm();
  }
}

// max of |h(q)| and |Dh v| / max(1, |v|); 0 where there are no holonomic constraints.
template <class System, class T, int n>
T holonomic_error(const System& system, const Vector<T, n>& q, const Vector<T, n>& v) {
  if constexpr (IsErased<System>) {
    return system.holonomic_error(q, v);
  } else if constexpr (HolonomicSystem<System>) {
    const T size = std::max(T(1), v.cwiseAbs().maxCoeff());
    const T hidden = hidden_residual(system.scene(), q, v) / size;
    return std::max(holonomic_residual(system.scene(), q), hidden);
  } else {
    return T(0);
  }
}

}  // namespace carnot
