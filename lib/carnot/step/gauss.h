// The Gauss methods with the number of stages known to the compiler: s stages, order 2s.
#pragma once

#include "carnot/step/runge_kutta.h"
#include "carnot/tableau/gauss_tableau.h"

namespace carnot {

// One tableau per scalar and number of stages, made on first use.
template <class T, int s>
const Tableau<T, s>& fixed_gauss_tableau() {
  static const Tableau<T, s> kTableau = fixed_stages<s>(gauss_tableau<T>(s));
  return kTableau;
}

template <class System_, int s, class T = double>
class Gauss : public RungeKutta<System_, s, T> {
 public:
  static constexpr int kStages = s;
  static constexpr int kOrder = 2 * s;

  // Keeps a reference to `system`.
  explicit Gauss(const System_& system)
      : RungeKutta<System_, s, T>(system, fixed_gauss_tableau<T, s>()) {}
  using RungeKutta<System_, s, T>::RungeKutta;
};

}  // namespace carnot
