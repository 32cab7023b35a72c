// The Gauss methods by their number of stages: s stages, order 2s.
#pragma once

#include <type_traits>

#include "carnot/step/runge_kutta.h"
#include "carnot/tableau/gauss_tableau.h"

namespace carnot {

// The compiler is to know the number of stages where they fill a pack. All other methods of a
// system share one stepper.
template <class T, int s>
inline constexpr int kKnownStages = s == 8 && std::is_same_v<T, double> ? s : kAnyStages;

// One tableau per scalar and number of stages, made on first use.
template <class T, int s>
const Tableau<T, kKnownStages<T, s>>& fixed_gauss_tableau() {
  if constexpr (kKnownStages<T, s> == kAnyStages) {
    static const Tableau<T> kTableau = gauss_tableau<T>(s);
    return kTableau;
  } else {
    static const Tableau<T, s> kTableau = fixed_stages<s>(gauss_tableau<T>(s));
    return kTableau;
  }
}

template <class System_, int s, class T = double>
class Gauss : public RungeKutta<System_, kKnownStages<T, s>, T> {
 public:
  static constexpr int kStages = s;
  static constexpr int kOrder = 2 * s;

  // Keeps a reference to `system`.
  explicit Gauss(const System_& system)
      : RungeKutta<System_, kKnownStages<T, s>, T>(system, fixed_gauss_tableau<T, s>()) {}
  using RungeKutta<System_, kKnownStages<T, s>, T>::RungeKutta;
};

}  // namespace carnot
