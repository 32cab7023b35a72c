// rate() on W phase points side by side, from and to plain numbers.
#pragma once

#include <algorithm>
#include <array>

#include "carnot/numerics/gradient.h"
#include "carnot/numerics/pack.h"
#include "carnot/system/index_one_system.h"

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
  if constexpr (IsErased<System>) {
    return system.template packed_rate<W>(t, z, y, z_dot);
  } else {
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
}

// d(z_dot)/dz at W points side by side: entry (r, c) of all is row 2n r + c of `jacobian`, times
// the row `weights`. The rate on Jets of packs, kDirections columns at a time: Jets of all 2n
// directions do not fit the registers, and take the compiler several times as long. False when some
// lane fails.
template <int W, class System>
[[gnu::flatten, gnu::noinline]] bool packed_jacobian(const System& system,
                                                     const double* t,
                                                     const double* z,
                                                     const double* weights,
                                                     double* jacobian) {
  if constexpr (IsErased<System>) {
    static_assert(W == 8);
    return system.packed_jacobian(t, z, weights, jacobian);
  } else {
    constexpr int n = System::kDof;
    constexpr int kDirections = 3;
    using P = Pack<W>;
    using J = Jet<P, kDirections>;
    const P weight = P::load(weights);
    for (int first = 0; first < 2 * n; first += kDirections) {
      Vector<J, n> q;
      Vector<J, n> p;
      for (int i = 0; i < n; ++i) {
        q[i].a = P::load(z + i * W);
        p[i].a = P::load(z + (n + i) * W);
        for (int d = 0; d < kDirections; ++d) {
          q[i].v[d] = P(first + d == i ? 1 : 0);
          p[i].v[d] = P(first + d == n + i ? 1 : 0);
        }
      }
      Vector<J, System::kAlgebraic> y;
      Rate<J, n> rate;
      if (system.rate(J(P::load(t)), q, p, y, rate) != RateStatus::kOk) return false;
      for (int d = 0; d < kDirections && first + d < 2 * n; ++d) {
        double* const column = jacobian + (first + d) * W;
        for (int r = 0; r < n; ++r) {
          (weight * rate.q_dot[r].v[d]).store(column + 2 * n * r * W);
          (weight * rate.p_dot[r].v[d]).store(column + 2 * n * (n + r) * W);
        }
      }
    }
    return true;
  }
}

// The same for columns first, ..., first + count - 1 of matrices with a column for each point, up
// to W of them; idle lanes repeat the last.
template <int W, class System, class Points, class Algebraic>
bool columns_in_pack(const System& system,
                     const double* t,
                     int first,
                     int count,
                     const Points& z,
                     Algebraic& y,
                     Points& z_dot) {
  constexpr int size = 2 * System::kDof;
  constexpr int m = System::kAlgebraic;
  alignas(64) std::array<double, W> time;
  alignas(64) std::array<double, size * W> points;
  alignas(64) std::array<double, size * W> rates;
  alignas(64) std::array<double, m * W> solutions;
  int used = m;
  if constexpr (IsErased<System>) used = system.algebraic_count();
  for (int l = 0; l < W; ++l) {
    const int column = std::min(l, count - 1);
    time[l] = t[column];
    for (int k = 0; k < size; ++k) points[k * W + l] = z(k, first + column);
    if constexpr (IsErased<System>) {  // it may iterate, from the y of each point
      for (int k = 0; k < used; ++k) solutions[k * W + l] = y(k, first + column);
    }
  }
  if (!packed_rate<W>(system, time.data(), points.data(), solutions.data(), rates.data())) {
    return false;
  }
  for (int l = 0; l < count; ++l) {
    for (int k = 0; k < size; ++k) z_dot(k, first + l) = rates[k * W + l];
    for (int k = 0; k < used; ++k) y(k, first + l) = solutions[k * W + l];
  }
  return true;
}

// Up to eight of them, in a pack of four where that will do.
template <class System, class Points, class Algebraic>
bool packed_columns(const System& system,
                    const double* t,
                    int first,
                    int count,
                    const Points& z,
                    Algebraic& y,
                    Points& z_dot) {
  if constexpr (!IsErased<System>) {
    if (count <= 4) return columns_in_pack<4>(system, t, first, count, z, y, z_dot);
  }
  return columns_in_pack<8>(system, t, first, count, z, y, z_dot);
}

}  // namespace carnot
