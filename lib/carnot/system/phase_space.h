// Phase points z = (q, p) as the integrators see them: their state, their rate, its derivative.
#pragma once

#include "carnot/numerics/compensated.h"
#include "carnot/numerics/gradient.h"
#include "carnot/system/index_one_system.h"

namespace carnot {

// A phase point with its rounding error: z = (q, p) as one vector of length 2n.
template <class T, int n>
using State = Compensated<Vector<T, 2 * n>>;

template <class T, int n>
State<T, n> make_state(const Vector<T, n>& q, const Vector<T, n>& p) {
  State<T, n> z;
  for (int i = 0; i < n; ++i) {
    z.value[i] = q[i];
    z.value[n + i] = p[i];
    z.compensation[i] = z.compensation[n + i] = T(0);
  }
  return z;
}

// dz/dt for z = (q, p); y is scratch and warm start. One copy for all callers, never inlined: the
// loops over stages are faster so, by a tenth.
template <class System, class T>
[[gnu::noinline]] RateStatus phase_rate(const System& system,
                                        const T& t,
                                        const Vector<T, 2 * System::kDof>& z,
                                        Vector<T, System::kAlgebraic>& y,
                                        Vector<T, 2 * System::kDof>& z_dot) {
  if constexpr (IsErased<System>) {
    return system.phase_rate(t, z, y, z_dot);
  } else {
    constexpr int n = System::kDof;
    Vector<T, n> q;
    Vector<T, n> p;
    for (int i = 0; i < n; ++i) q[i] = z[i];
    for (int i = 0; i < n; ++i) p[i] = z[n + i];
    Rate<T, n> rate;
    const RateStatus status = system.rate(t, q, p, y, rate);
    if (status != RateStatus::kOk) return status;
    for (int i = 0; i < n; ++i) z_dot[i] = rate.q_dot[i];
    for (int i = 0; i < n; ++i) z_dot[n + i] = rate.p_dot[i];
    return status;
  }
}

// d(dz/dt)/dz, exact: the rate on Jets with 2n directions. y is the solution at z.
template <class System, class T>
RateStatus phase_jacobian(const System& system,
                          const T& t,
                          const Vector<T, 2 * System::kDof>& z,
                          const Vector<T, System::kAlgebraic>& y,
                          Matrix<T, 2 * System::kDof, 2 * System::kDof>& jacobian) {
  if constexpr (IsErased<System>) {
    return system.phase_jacobian(t, z, y, jacobian);
  } else {
    constexpr int m = 2 * System::kDof;
    using J = Jet<T, m>;
    Vector<J, m> rate;
    Vector<J, System::kAlgebraic> warm = unseeded<J>(y);
    const RateStatus status = phase_rate(system, J(t), seeded(z), warm, rate);
    if (status != RateStatus::kOk) return status;
    jacobian = tangents(rate);
    return status;
  }
}

}  // namespace carnot
