// rate() on W phase points side by side, from and to plain numbers.
#pragma once

#include "carnot/index_one_system.h"
#include "carnot/pack.h"

namespace carnot {

// The system's rate() is without branches on values, so it runs on packs.
template <class System>
concept PacksRates = System::kPacks;

// z_dot and y at z and the times t, all in rows of W numbers, one per lane: t one row, z and z_dot
// 2n of them, y m. False when some lane fails: ask rate() one by one which and why. Everything it
// calls is inlined, or registers would go through memory.
template <int W, class System, class Lane = typename pack_lane::Widest<W>::type>
[[gnu::flatten, gnu::noinline]] bool packed_rate(
    const System& system, const double* t, const double* z, double* y, double* z_dot) {
  constexpr int n = System::kDof;
  using P = Pack<W, Lane>;
  Vector<P, n> q;
  Vector<P, n> p;
  for (int i = 0; i < n; ++i) {
    q[i] = P::load(z + i * W);
    p[i] = P::load(z + (n + i) * W);
  }
  Vector<P, System::kAlgebraic> algebraic;
  Rate<P, n> rate;
  if (system.rate(P::load(t), q, p, algebraic, rate) != RateStatus::kOk) return false;
  for (int i = 0; i < n; ++i) {
    rate.q_dot[i].store(z_dot + i * W);
    rate.p_dot[i].store(z_dot + (n + i) * W);
  }
  for (int i = 0; i < System::kAlgebraic; ++i) algebraic[i].store(y + i * W);
  return true;
}

}  // namespace carnot
