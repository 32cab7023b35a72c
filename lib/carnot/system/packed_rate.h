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

// The part of packed_rate() that fills one register: S lanes of rows of W numbers. Everything it
// calls is inlined, or registers would go through memory.
template <int S, int W, class Lane, class System>
CARNOT_FLATTEN [[gnu::noinline]] bool rate_in_register(
    const System& system, const double* t, const double* z, double* y, double* z_dot) {
  constexpr int n = System::kDof;
  using P = Pack<S, Lane>;
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

// z_dot and y at z and the times t, all in rows of W numbers, one per lane: t one row, z and z_dot
// 2n of them, y m. False when some lane fails: ask rate() one by one which and why. A register at a
// time: with SSE2 a rate of the vehicle takes 55 ns with all of eight lanes at once and 18 ns so,
// with AVX2 15 ns and 8 ns (Zen 5).
template <int W, class System, class Lane = typename pack_lane::Widest<W>::type>
bool packed_rate(const System& system, const double* t, const double* z, double* y, double* z_dot) {
  if constexpr (IsErased<System>) {
    return system.template packed_rate<W>(t, z, y, z_dot);
  } else {
    constexpr int S = kRegisterLanes<W, Lane>;
    for (int l = 0; l < W; l += S) {
      if (!rate_in_register<S, W, Lane>(system, t + l, z + l, y + l, z_dot + l)) return false;
    }
    return true;
  }
}

// Directions that are differentiated at once: Jets of all 2n do not fit the registers, and take the
// compiler several times as long. Of many coordinates fewer, for the sake of the stack: a mass
// matrix on Jets of them takes n^2 (n + 1) (directions + 1) packs.
template <int n>
inline constexpr int kPackedDirections = n <= 7   ? std::min(3, 2 * n)
                                         : n == 8 ? 2
                                                  : 1;

// The part of packed_slopes() that fills one register: S lanes of rows of W numbers.
template <int S, int W, class System>
CARNOT_FLATTEN [[gnu::noinline]] bool slopes_in_register(
    const System& system,
    const double* t,
    const double* z,
    const std::array<const double*, kPackedDirections<System::kDof>>& seeds,
    const double* weights,
    int stride,
    double* slopes) {
  constexpr int n = System::kDof;
  constexpr int kDirections = kPackedDirections<n>;
  using P = Pack<S>;
  using J = Jet<P, kDirections>;
  Vector<J, n> q;
  Vector<J, n> p;
  for (int i = 0; i < n; ++i) {
    q[i].a = P::load(z + i * W);
    p[i].a = P::load(z + (n + i) * W);
    for (int d = 0; d < kDirections; ++d) {
      q[i].v[d] = P::load(seeds[d] + i * W);
      p[i].v[d] = P::load(seeds[d] + (n + i) * W);
    }
  }
  Vector<J, System::kAlgebraic> y;
  Rate<J, n> rate;
  if (system.rate(J(P::load(t)), q, p, y, rate) != RateStatus::kOk) return false;
  const P weight = P::load(weights);
  for (int i = 0; i < n; ++i) {
    for (int d = 0; d < kDirections; ++d) {
      (weight * rate.q_dot[i].v[d]).store(slopes + (i * stride + d) * W);
      (weight * rate.p_dot[i].v[d]).store(slopes + ((n + i) * stride + d) * W);
    }
  }
  return true;
}

// The derivatives of z_dot at W points side by side in some directions, that of each lane its own:
// direction d is the 2n rows seeds[d], and derivative r in that direction, times the row `weights`,
// becomes row r stride + d of `slopes`. The rate on Jets of packs, a register at a time: with SSE2
// a Jacobian of the vehicle takes 852 ns with all lanes at once and 316 ns so, with AVX2 216 ns and
// 226 ns (Zen 5), and README's coin compiles in 13 s instead of 34 s, with AVX2 in 12.6 s instead
// of 16.1 s. False when some lane fails.
template <int W, class System>
bool packed_slopes(const System& system,
                   const double* t,
                   const double* z,
                   const std::array<const double*, kPackedDirections<System::kDof>>& seeds,
                   const double* weights,
                   int stride,
                   double* slopes) {
  constexpr int S = kRegisterLanes<W>;
  for (int l = 0; l < W; l += S) {
    auto of_part = seeds;
    for (const double*& seed : of_part) seed += l;
    if (!slopes_in_register<S, W>(system, t + l, z + l, of_part, weights + l, stride, slopes + l)) {
      return false;
    }
  }
  return true;
}

// d(z_dot)/dz at W points side by side: entry (r, c) of all is row 2n r + c of `jacobian`, times
// the row `weights`. False when some lane fails.
template <int W, class System>
bool packed_jacobian(const System& system,
                     const double* t,
                     const double* z,
                     const double* weights,
                     double* jacobian) {
  if constexpr (IsErased<System>) {
    static_assert(W == 8);
    return system.packed_jacobian(t, z, weights, jacobian);
  } else {
    constexpr int kSize = 2 * System::kDof;
    constexpr int kDirections = kPackedDirections<System::kDof>;
    // Row `kSize` is one and all others are zero, so that the unit vectors are windows on them.
    alignas(64) static constexpr auto kUnits = [] {
      std::array<double, 2 * kSize * W> rows{};
      for (int l = 0; l < W; ++l) rows[kSize * W + l] = 1;
      return rows;
    }();
    for (int next = 0; next < kSize; next += kDirections) {
      const int first = std::min(next, kSize - kDirections);
      std::array<const double*, kDirections> seeds;
      for (int d = 0; d < kDirections; ++d) seeds[d] = kUnits.data() + (kSize - first - d) * W;
      if (!packed_slopes<W>(system, t, z, seeds, weights, kSize, jacobian + first * W))
        return false;
    }
    return true;
  }
}

// d(z_dot)/dz at one point, column by column: each lane of a pack takes some of the columns.
template <class System>
bool jacobian_in_pack(const System& system, double t, const double* z, double* jacobian) {
  constexpr int W = 8;
  constexpr int kSize = 2 * System::kDof;
  constexpr int kDirections = kPackedDirections<System::kDof>;
  constexpr int kAtOnce = kDirections * W;
  alignas(64) std::array<double, W> time;
  alignas(64) std::array<double, W> weights;
  alignas(64) std::array<double, kSize * W> points;
  alignas(64) std::array<std::array<double, kSize * W>, kDirections> units;
  alignas(64) std::array<double, kSize * kDirections * W> slopes;
  std::array<const double*, kDirections> seeds;
  for (int d = 0; d < kDirections; ++d) seeds[d] = units[d].data();
  time.fill(t);
  weights.fill(1);
  for (int k = 0; k < kSize; ++k) std::fill_n(points.data() + k * W, W, z[k]);
  for (int first = 0; first < kSize; first += kAtOnce) {
    const int count = std::min(kAtOnce, kSize - first);
    // Column first + c is direction c / W of lane c % W.
    for (auto& unit : units) unit.fill(0);
    for (int c = 0; c < count; ++c) units[c / W][(first + c) * W + c % W] = 1;
    if (!packed_slopes<W>(system,
                          time.data(),
                          points.data(),
                          seeds,
                          weights.data(),
                          kDirections,
                          slopes.data())) {
      return false;
    }
    for (int c = 0; c < count; ++c) {
      for (int r = 0; r < kSize; ++r) {
        jacobian[(first + c) * kSize + r] = slopes[(r * kDirections + c / W) * W + c % W];
      }
    }
  }
  return true;
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
  constexpr int kSize = 2 * System::kDof;
  constexpr int m = System::kAlgebraic;
  alignas(64) std::array<double, W> time;
  alignas(64) std::array<double, kSize * W> points;
  alignas(64) std::array<double, kSize * W> rates;
  alignas(64) std::array<double, m * W> solutions;
  int used = m;
  if constexpr (IsErased<System>) used = system.algebraic_count();
  for (int l = 0; l < W; ++l) {
    const int column = std::min(l, count - 1);
    time[l] = t[column];
    for (int k = 0; k < kSize; ++k) points[k * W + l] = z(k, first + column);
    if constexpr (IsErased<System>) {  // it may iterate, from the y of each point
      for (int k = 0; k < used; ++k) solutions[k * W + l] = y(k, first + column);
    }
  }
  if (!packed_rate<W>(system, time.data(), points.data(), solutions.data(), rates.data())) {
    return false;
  }
  for (int l = 0; l < count; ++l) {
    for (int k = 0; k < kSize; ++k) z_dot(k, first + l) = rates[k * W + l];
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
