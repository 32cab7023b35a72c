// W numbers side by side: one text of a formula, W stages of a step or W trajectories at once.
//
// A Pack is a scalar for the templated formulas. Its parts are the widest registers that divide it
// and that the compiler may use (AVX-512, AVX, SSE2, ...); on a target without any, or on request,
// plain doubles. Packs stay inside functions: their layout depends on the instruction set, so they
// appear in no public type and no memory that outlives a call.
//
// Comparisons give a Mask, which is not a bool: the lanes may differ. A formula that branches on a
// value does not compile on packs; write select(mask, a, b), or say `kScalarOnly = true` in the
// scene, which is then evaluated number by number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "carnot/numerics/scalar.h"

// Everything that a function marked by this calls is inlined into it, so that packs stay in
// registers. The compiler takes a fifth longer for it. Programs whose speed is of no matter define
// CARNOT_NO_FLATTEN.
#ifdef CARNOT_NO_FLATTEN
#define CARNOT_FLATTEN
#else
#define CARNOT_FLATTEN [[gnu::flatten]]
#endif

namespace carnot {

namespace pack_lane {

// The register that holds W doubles, or the largest half, quarter, ... of them; else double.
template <int W>
struct Widest {
  static auto choose() {
#ifndef XSIMD_NO_SUPPORTED_ARCHITECTURE
    if constexpr (W > 1) {
      using Batch = xsimd::make_sized_batch_t<double, W>;
      if constexpr (std::is_void_v<Batch>) {
        return Widest<W / 2>::choose();
      } else {
        return Batch{};
      }
    } else {
      return double{};
    }
#else
    return double{};
#endif
  }
  using type = decltype(choose());
};

// What a Pack asks of its parts, for registers and for plain doubles.
template <class Lane>
struct Ops {
  using Register = typename Lane::register_type;
  using Bools = typename Lane::batch_bool_type;
  static constexpr int kSize = Lane::size;
  static Lane of(Register x) { return Lane(x); }
  static Register register_of(const Lane& x) { return x; }
  static Lane load(const double* x) { return Lane::load_unaligned(x); }
  static void store(const Lane& x, double* to) { x.store_unaligned(to); }
  static bool all(const Bools& x) { return xsimd::all(x); }
  static bool any(const Bools& x) { return xsimd::any(x); }
  static Lane select(const Bools& x, const Lane& a, const Lane& b) {
    return xsimd::select(x, a, b);
  }
  static Lane sqrt(const Lane& x) { return xsimd::sqrt(x); }
  static Lane abs(const Lane& x) { return xsimd::abs(x); }
  static Lane max(const Lane& a, const Lane& b) { return xsimd::max(a, b); }
  static Lane min(const Lane& a, const Lane& b) { return xsimd::min(a, b); }
  // Later versions of xsimd have another name for it.
  static double sum(const Lane& x) {
    if constexpr (requires { reduce_add(x); }) {
      return reduce_add(x);
    } else {
      return hadd(x);
    }
  }
  static double largest(const Lane& x) {
    std::array<double, kSize> lanes;
    store(x, lanes.data());
    for (int half = kSize / 2; half > 0; half /= 2) {
      for (int i = 0; i < half; ++i) lanes[i] = std::max(lanes[i], lanes[i + half]);
    }
    return lanes[0];
  }
};

template <>
struct Ops<double> {
  using Register = double;
  using Bools = bool;
  static constexpr int kSize = 1;
  static double of(double x) { return x; }
  static double register_of(double x) { return x; }
  static double load(const double* x) { return *x; }
  static void store(double x, double* to) { *to = x; }
  static bool all(bool x) { return x; }
  static bool any(bool x) { return x; }
  static double select(bool x, double a, double b) { return x ? a : b; }
  static double sqrt(double x) { return std::sqrt(x); }
  static double abs(double x) { return std::abs(x); }
  static double max(double a, double b) { return a < b ? b : a; }
  static double min(double a, double b) { return b < a ? b : a; }
  static double largest(double x) { return x; }
  static double sum(double x) { return x; }
};

}  // namespace pack_lane

// How many of W lanes fill one register, two where there are none; W where that does not divide
// it. What calculates with more numbers than there are registers may take the lanes of a wide pack
// so many at a time.
template <int W, class Lane = typename pack_lane::Widest<W>::type>
inline constexpr int kRegisterLanes = W % 2 == 0 ? std::max(2, pack_lane::Ops<Lane>::kSize) : W;

namespace pack_lane {

template <class Lane>
struct SinCos {
  Lane sin;
  Lane cos;
};

// Beyond this the reduction below loses digits; those arguments give NaN.
inline constexpr double kLargestAngle = 1e6;

// r, or NaN in the lanes where |x| is beyond that.
template <class Lane>
[[gnu::always_inline]] inline Lane nan_beyond(const Lane& x, const Lane& r) {
  const Lane nan(std::numeric_limits<double>::quiet_NaN());
  return xsimd::select(xsimd::abs(x) <= Lane(kLargestAngle), r, nan);
}

// From sin r and cos r those of r + n pi/2, for n in the low bits of `shifted`: the quadrant n mod
// 4 swaps them and sets signs.
template <class Lane>
[[gnu::always_inline]] inline SinCos<Lane> turned(const Lane& shifted, const SinCos<Lane>& of_r) {
  using Integer = xsimd::batch<std::int64_t, typename Lane::arch_type>;
  const auto quadrant = xsimd::bitwise_cast<Integer>(shifted);
  const auto even = xsimd::bitwise_cast<Lane>(quadrant & Integer(1)) == Lane(0.0);
  const Integer sign(std::numeric_limits<std::int64_t>::min());
  const Lane sine_sign = xsimd::bitwise_cast<Lane>((quadrant << 62) & sign);
  const Lane cosine_sign = xsimd::bitwise_cast<Lane>(((quadrant + Integer(1)) << 62) & sign);
  return {xsimd::select(even, of_r.sin, of_r.cos) ^ sine_sign,
          xsimd::select(even, of_r.cos, of_r.sin) ^ cosine_sign};
}

// sin and cos to 2 ulp for |x| <= kLargestAngle. With x = n pi/2 + r, |r| <= pi/4, n is the nearest
// integer (adding 1.5 2^52 rounds, and leaves n in the low bits), n pi/2 is subtracted in three
// parts whose products with n are exact (Cody & Waite 1980), and polynomials in r^2 follow,
// evaluated in pairs so that the chain is short.
//
// Errors far below an ulp matter where they are the same on every turn of an angle, because H then
// drifts by them: with r rounded to double, by 1e-18 of H in each turn. So `rest`, which is what
// that rounding leaves, is carried along, and the polynomials are good to 5e-20: least squares on
// [0, (pi/4)^2] in 60 digits, each coefficient rounded before the next one is found.
template <class Lane>
[[gnu::always_inline]] inline SinCos<Lane> sin_cos(const Lane& x) {
  if constexpr (std::is_same_v<Lane, double>) {
    return {std::sin(x), std::cos(x)};
  } else {
    using xsimd::fma, xsimd::fnma;
    const Lane round(6755399441055744.0);
    const Lane shifted = fma(x, Lane(0.63661977236758134308), round);
    const Lane n = shifted - round;
    const Lane first = fnma(n, Lane(1.57079632673412561417e+00), x);
    const Lane second = n * Lane(6.07710050630396597660e-11);
    const Lane unguarded = first - second;
    const Lane rest = fnma(n, Lane(2.02226624879595063154e-21), (first - unguarded) - second);
    const Lane r = nan_beyond(x, unguarded);
    const Lane z = r * r;
    const Lane z2 = z * z;
    const Lane z4 = z2 * z2;
    const Lane s0 = fma(z, Lane(0x1.111111111109ap-7), Lane(-0x1.5555555555555p-3));
    const Lane s1 = fma(z, Lane(0x1.71de3a44c9fa2p-19), Lane(-0x1.a01a01a00a47fp-13));
    const Lane s2 = fma(z, Lane(0x1.611863e81a19dp-33), Lane(-0x1.ae644352a5dc4p-26));
    const Lane s3 = fma(z2, Lane(-0x1.a72510efe0438p-41), s2);
    const Lane c0 = fma(z, Lane(-0x1.6c16c16c1504cp-10), Lane(0x1.555555555554bp-5));
    const Lane c1 = fma(z, Lane(-0x1.27e4f7f911e50p-22), Lane(0x1.a01a019c97a13p-16));
    const Lane c2 = fma(z, Lane(-0x1.8fa9a73e06142p-37), Lane(0x1.1ee9e17e68098p-29));
    const Lane half = fnma(z, Lane(0.5), Lane(1));
    const Lane s = r + fma(fma(z4, s3, fma(z2, s1, s0)), z * r, rest * half);
    const Lane c = half + fma(z2, fma(z4, c2, fma(z2, c1, c0)), -(rest * r));
    return turned(shifted, SinCos<Lane>{s, c});
  }
}

}  // namespace pack_lane

template <int W, class Lane = typename pack_lane::Widest<W>::type>
class Pack {
 public:
  using Ops = pack_lane::Ops<Lane>;
  static constexpr int kLanes = W;
  static constexpr int kParts = W / Ops::kSize;
  static_assert(W % Ops::kSize == 0);

  // One truth value per lane.
  struct Mask {
    Mask() = default;
    Mask(bool x) {
      for (auto& part : parts) part = typename Ops::Bools(x);
    }
    explicit operator bool() const = delete;  // the lanes may differ: all(), any() or select()

    [[nodiscard]] friend bool all(const Mask& a) {
      bool result = true;
      for (int i = 0; i < kParts; ++i) result = result && Ops::all(a.parts[i]);
      return result;
    }
    [[nodiscard]] friend bool any(const Mask& a) {
      bool result = false;
      for (int i = 0; i < kParts; ++i) result = result || Ops::any(a.parts[i]);
      return result;
    }

    typename Ops::Bools parts[kParts];
  };
  friend Pack select(const Mask& mask, const Pack& a, const Pack& b) {
    return each([&](int i) { return Ops::select(mask.parts[i], a.part(i), b.part(i)); });
  }

  // Copies register by register: else compilers copy piecewise, which the next load waits for.
  Pack() = default;  // Pack() is zero, as Scalar() must be for Jets; `Pack x;` is not set
  [[gnu::always_inline]] Pack(const Pack& other) {
    for (int i = 0; i < kParts; ++i) part_[i] = other.part_[i];
  }
  // NOLINTNEXTLINE(bugprone-unhandled-self-assignment): a register is the same after `x = x`
  [[gnu::always_inline]] Pack& operator=(const Pack& other) {
    for (int i = 0; i < kParts; ++i) part_[i] = other.part_[i];
    return *this;
  }
  // The same number in every lane.
  template <class Number>
  requires std::is_arithmetic_v<Number> Pack(Number x) {
    for (auto& part : part_) part = Ops::register_of(Lane(static_cast<double>(x)));
  }
  static Pack load(const double* x) {
    return each([&](int i) { return Ops::load(x + i * Ops::kSize); });
  }
  void store(double* to) const {
    for (int i = 0; i < kParts; ++i) Ops::store(part(i), to + i * Ops::kSize);
  }

  // Inlined whatever the size of the rest: a call moves registers through memory.
  [[gnu::always_inline]] Pack operator-() const {
    return each([&](int i) { return -part(i); });
  }
  [[gnu::always_inline]] friend Pack operator+(const Pack& a, const Pack& b) {
    return each([&](int i) { return a.part(i) + b.part(i); });
  }
  [[gnu::always_inline]] friend Pack operator-(const Pack& a, const Pack& b) {
    return each([&](int i) { return a.part(i) - b.part(i); });
  }
  [[gnu::always_inline]] friend Pack operator*(const Pack& a, const Pack& b) {
    return each([&](int i) { return a.part(i) * b.part(i); });
  }
  [[gnu::always_inline]] friend Pack operator/(const Pack& a, const Pack& b) {
    return each([&](int i) { return a.part(i) / b.part(i); });
  }
  [[gnu::always_inline]] Pack& operator+=(const Pack& b) { return *this = *this + b; }
  [[gnu::always_inline]] Pack& operator-=(const Pack& b) { return *this = *this - b; }
  [[gnu::always_inline]] Pack& operator*=(const Pack& b) { return *this = *this * b; }
  [[gnu::always_inline]] Pack& operator/=(const Pack& b) { return *this = *this / b; }

  friend Mask operator<(const Pack& a, const Pack& b) {
    return compare([&](int i) { return a.part(i) < b.part(i); });
  }
  friend Mask operator<=(const Pack& a, const Pack& b) {
    return compare([&](int i) { return a.part(i) <= b.part(i); });
  }
  friend Mask operator>(const Pack& a, const Pack& b) { return b < a; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return b <= a; }

  friend Pack sqrt(const Pack& a) {
    return each([&](int i) { return Ops::sqrt(a.part(i)); });
  }
  friend Pack abs(const Pack& a) {
    return each([&](int i) { return Ops::abs(a.part(i)); });
  }
  friend Pack max(const Pack& a, const Pack& b) {
    return each([&](int i) { return Ops::max(a.part(i), b.part(i)); });
  }
  friend Pack min(const Pack& a, const Pack& b) {
    return each([&](int i) { return Ops::min(a.part(i), b.part(i)); });
  }
  // To 2 ulp for |x| <= 1e6; NaN beyond.
  friend Pack sin(const Pack& a) {
    return each([&](int i) { return pack_lane::sin_cos(a.part(i)).sin; });
  }
  friend Pack cos(const Pack& a) {
    return each([&](int i) { return pack_lane::sin_cos(a.part(i)).cos; });
  }
  friend SineAndCosine<Pack> sine_and_cosine(const Pack& a) {
    SineAndCosine<Pack> result;
    for (int i = 0; i < kParts; ++i) {
      const auto both = pack_lane::sin_cos(a.part(i));
      result.sine.part_[i] = Ops::register_of(both.sin);
      result.cosine.part_[i] = Ops::register_of(both.cos);
    }
    return result;
  }
  friend Pack tan(const Pack& a) {
    const auto both = sine_and_cosine(a);
    return both.sine / both.cosine;
  }
  // Number by number.
  friend Pack exp(const Pack& a) {
    return each_number(a, [](double x) { return std::exp(x); });
  }
  friend Pack log(const Pack& a) {
    return each_number(a, [](double x) { return std::log(x); });
  }
  friend Pack tanh(const Pack& a) {
    return each_number(a, [](double x) { return std::tanh(x); });
  }

  // Of the lanes.
  friend double largest(const Pack& a) {
    Lane most = a.part(0);
    for (int i = 1; i < kParts; ++i) most = Ops::max(most, a.part(i));
    return Ops::largest(most);
  }
  friend double sum(const Pack& a) {
    Lane all = a.part(0);
    for (int i = 1; i < kParts; ++i) all = all + a.part(i);
    return Ops::sum(all);
  }

  friend Mask isfinite(const Pack& a) { return abs(a) <= Pack(std::numeric_limits<double>::max()); }

  // The registers.
  [[nodiscard]] Lane part(int i) const { return Ops::of(part_[i]); }
  static Pack of_part(const Lane& x) requires(kParts == 1) {
    return each([&](int) { return x; });
  }

 private:
  template <class F>
  [[gnu::always_inline]] static Pack each(F f) {
    Pack result;
    for (int i = 0; i < kParts; ++i) result.part_[i] = Ops::register_of(f(i));
    return result;
  }
  template <class F>
  [[gnu::always_inline]] static Mask compare(F f) {
    Mask result;
    for (int i = 0; i < kParts; ++i) result.parts[i] = f(i);
    return result;
  }
  template <class F>
  static Pack each_number(const Pack& a, F f) {
    std::array<double, W> x;
    a.store(x.data());
    for (double& number : x) number = f(number);
    return load(x.data());
  }

  typename Ops::Register part_[kParts];
};

template <class T>
struct IsPack : std::false_type {};
template <int W, class Lane>
struct IsPack<Pack<W, Lane>> : std::true_type {};
template <class T>
inline constexpr bool kIsPack = IsPack<T>::value;

template <int W, class Lane>
struct RealOf<Pack<W, Lane>> {
  using type = double;
};

}  // namespace carnot

namespace Eigen {

template <int W, class Lane>
struct NumTraits<carnot::Pack<W, Lane>> : NumTraits<double> {
  using Real = carnot::Pack<W, Lane>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
};

}  // namespace Eigen
