// The harmonic oscillator as a system of its own, without algebraic variables: H = (p^2 + k q^2)/2.
#pragma once

#include "carnot/system/index_one_system.h"

namespace carnot::test {

struct Oscillator {
  static constexpr int kDof = 1;
  static constexpr int kAlgebraic = 0;
  static constexpr int kMultipliers = 0;
  static constexpr bool kAutonomous = true;

  double stiffness = 1;

  template <class T>
  [[nodiscard]] RateStatus rate(const T& /*t*/,
                                const Vector<T, 1>& q,
                                const Vector<T, 1>& p,
                                Vector<T, 0>& /*y*/,
                                Rate<T, 1>& out) const {
    out.q_dot = p;
    out.p_dot = -constant<T>(stiffness) * q;
    return RateStatus::kOk;  // whatever q and p: the integrator has to look itself
  }
};

}  // namespace carnot::test
