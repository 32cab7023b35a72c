// Systems that look on, or fail on purpose. Their state is mutable: for one thread, in tests only.
#pragma once

#include "carnot/system/index_one_system.h"
#include "carnot/system/velocity_constraints.h"

namespace carnot::test {

// Counts rate() on plain numbers, and fails the calls with these numbers (from 1).
template <class System>
struct CountingSystem : System {
  using System::System;
  static constexpr bool kPacks = false;  // one by one
  mutable long calls = 0;
  long fail_from = -1;
  long fail_to = -1;

  template <class T>
  [[nodiscard]] RateStatus rate(const T& t,
                                const Vector<T, System::kDof>& q,
                                const Vector<T, System::kDof>& p,
                                Vector<T, System::kAlgebraic>& y,
                                Rate<T, System::kDof>& out) const {
    const RateStatus status = System::rate(t, q, p, y, out);
    if constexpr (!kIsJet<T>) {
      ++calls;
      if (calls >= fail_from && calls <= fail_to) return RateStatus::kNotFinite;
    }
    return status;
  }
};

}  // namespace carnot::test
