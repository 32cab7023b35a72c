// The right-hand sides of `carnot benchmark` in closed form, by hand: the same for every peer.
//
// They are what an author who knows the problem would write for a general solver: the constraints
// solved on paper, no matrices, no branches, sine and cosine inline. On doubles, and on packs of
// them for carnot_micro.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "carnot/numerics/pack.h"

namespace carnot::apps {

template <class T>
struct SineCosine {
  T sine;
  T cosine;
};

template <int W, class Lane>
SineCosine<Pack<W, Lane>> sine_cosine(const Pack<W, Lane>& x) {
  return {sin(x), cos(x)};
}

// To about an ulp of 1. Cody & Waite: x = k pi/2 + r with pi/2 as a sum of two doubles, the first
// of 33 bits, so that k times it is exact; then the Taylor polynomials of degree 15 and 16, whose
// remainders at pi/4 are below half a unit of round-off.
inline SineCosine<double> sine_cosine(double x) {
  constexpr double kFar = 1e5;
  if (!(std::abs(x) < kFar)) return {std::sin(x), std::cos(x)};
  constexpr double kHigh = 0x1.921fb544p+0;
  constexpr double kLow = 0x1.0b4611a626331p-34;
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  constexpr double kRound = 0x1.8p52;  // a sum with it is an integer, in the last bits
  const double shifted = x * kTwoOverPi + kRound;
  const double k = shifted - kRound;
  const auto quadrant = std::bit_cast<std::uint64_t>(shifted);
  const double r = (x - k * kHigh) - k * kLow;
  const double s = r * r;
  const double s2 = s * s;
  const double s4 = s2 * s2;
  // Estrin's scheme: short chains, since one trajectory waits for each of them.
  const double sin_low = (-1.0 / 6 + s * (1.0 / 120)) + s2 * (-1.0 / 5040 + s * (1.0 / 362880));
  const double sin_high = (-1.0 / 39916800 + s * (1.0 / 6227020800)) + s2 * (-1.0 / 1307674368000);
  const double cos_low = (1.0 / 24 + s * (-1.0 / 720)) + s2 * (1.0 / 40320 + s * (-1.0 / 3628800));
  const double cos_high =
      (1.0 / 479001600 + s * (-1.0 / 87178291200)) + s2 * (1.0 / 20922789888000);
  const double sine = r + (r * s) * (sin_low + s4 * sin_high);
  const double cosine = (1 - 0.5 * s) + s2 * (cos_low + s4 * cos_high);
  const bool swapped = (quadrant & 1U) != 0;
  const std::uint64_t sine_sign = (quadrant & 2U) << 62U;
  const std::uint64_t cosine_sign = ((quadrant + 1) & 2U) << 62U;
  const auto flip = [](double value, std::uint64_t sign) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ sign);
  };
  return {flip(swapped ? cosine : sine, sine_sign), flip(swapped ? sine : cosine, cosine_sign)};
}

// z = (x, y, theta, phi, p). With the frame (cos phi, sin phi, sin delta, 0), (0, 0, 0, 1),
// delta = phi - theta, the speeds are u1 = p.b1 / (1 + sin^2 delta) and u2 = p_phi.
struct VehicleRate {
  static constexpr int kSize = 8;

  template <class T>
  void operator()(const T* z, T* f) const {
    with_angles(z, sine_cosine(z[3]), sine_cosine(T(z[3] - z[2])), f);
  }

  template <class T>
  static void with_angles(const T* z, const SineCosine<T>& phi, const SineCosine<T>& delta, T* f) {
    const T u1 = (z[4] * phi.cosine + z[5] * phi.sine + z[6] * delta.sine) /
                 (T(1) + delta.sine * delta.sine);
    const T theta_dot = u1 * delta.sine;
    const T by_delta = u1 * delta.cosine * (z[6] - theta_dot);
    f[0] = u1 * phi.cosine;
    f[1] = u1 * phi.sine;
    f[2] = theta_dot;
    f[3] = z[7];
    f[4] = f[5] = T(0);
    f[6] = by_delta;
    f[7] = u1 * (z[4] * phi.sine - z[5] * phi.cosine) - by_delta;
  }
};

// grad V of V = -cos r, r^2 = |m|^2, m = (x - cos(theta)/2, y - sin(theta)/2): sin(r)/r m . dm/dq.
template <class T>
struct PotentialSlope {
  T x;
  T y;
  T theta;
};

template <class T>
PotentialSlope<T> vehicle_cosine_slope(const T* q, const SineCosine<T>& theta) {
  using std::sqrt;
  const T tiny(1e-300);  // r > 0 without a branch: sin(r)/r is 1 there
  const T half(0.5);
  const T mx = q[0] - half * theta.cosine;
  const T my = q[1] - half * theta.sine;
  const T r = sqrt(T(mx * mx + my * my + tiny));
  const T slope = sine_cosine(r).sine / r;
  return {slope * mx, slope * my, half * slope * (mx * theta.sine - my * theta.cosine)};
}

// The same in this potential.
struct VehicleCosineRate {
  static constexpr int kSize = 8;

  template <class T>
  void operator()(const T* z, T* f) const {
    const SineCosine<T> theta = sine_cosine(z[2]);
    const SineCosine<T> phi = sine_cosine(z[3]);
    const SineCosine<T> delta{phi.sine * theta.cosine - phi.cosine * theta.sine,
                              phi.cosine * theta.cosine + phi.sine * theta.sine};
    VehicleRate::with_angles(z, phi, delta, f);
    const PotentialSlope<T> slope = vehicle_cosine_slope(z, theta);
    f[4] -= slope.x;
    f[5] -= slope.y;
    f[6] -= slope.theta;
  }
};

// z = (x, y, z, p). With n = (y, -x), z' = n.u and s = p_z - z' the speeds are
// u = (p_x, p_y) + n s, and so s = (p_z - n.(p_x, p_y)) / (1 + |n|^2).
struct HeisenbergRate {
  static constexpr int kSize = 6;

  template <class T>
  void operator()(const T* z, T* f) const {
    const T s = (z[5] - (z[1] * z[3] - z[0] * z[4])) / (T(1) + z[0] * z[0] + z[1] * z[1]);
    f[0] = z[3] + z[1] * s;
    f[1] = z[4] - z[0] * s;
    f[2] = z[5] - s;
    f[3] = f[1] * s;
    f[4] = -f[0] * s;
    f[5] = T(0);
  }
};

// visit(rate) with the right-hand side of a scene of benchmark_trajectory.h.
template <class Visit>
auto with_rate(std::string_view scene, Visit&& visit) {
  if (scene == "vehicle-cosine") return visit(VehicleCosineRate{});
  if (scene == "vehicle") return visit(VehicleRate{});
  return visit(HeisenbergRate{});
}

}  // namespace carnot::apps
