// The classical explicit Runge-Kutta method of order 4: neither symplectic nor reversible, so the
// laws of geometric integration must fail on it.
#pragma once

#include "carnot/step/gauss.h"

namespace carnot::test {

// z after one step of length h. T may be a Jet: then the derivatives of the step come along.
template <class System, class T>
Vector<T, 2 * System::kDof> runge_kutta4_step(const System& system,
                                              const T& h,
                                              const Vector<T, 2 * System::kDof>& z) {
  using Z = Vector<T, 2 * System::kDof>;
  const T half = constant<T>(0.5) * h;
  const auto f = [&](const Z& x) {
    Vector<T, System::kAlgebraic> y;
    Z rate;
    (void)phase_rate(system, constant<T>(0), x, y, rate);
    return rate;
  };
  const Z k1 = f(z);
  const Z k2 = f(z + half * k1);
  const Z k3 = f(z + half * k2);
  const Z k4 = f(z + h * k3);
  return z + (h / constant<T>(6)) * (k1 + constant<T>(2) * (k2 + k3) + k4);
}

// d(step)/dz by Jets.
template <class System>
Matrix<double, 2 * System::kDof, 2 * System::kDof> runge_kutta4_tangent(
    const System& system, double h, const Vector<double, 2 * System::kDof>& z) {
  constexpr int kSize = 2 * System::kDof;
  using J = Jet<double, kSize>;
  const Vector<J, kSize> out = runge_kutta4_step(system, J(h), seeded(z));
  Matrix<double, kSize, kSize> m;
  for (int i = 0; i < kSize; ++i) m.row(i) = out[i].v.transpose();
  return m;
}

}  // namespace carnot::test
