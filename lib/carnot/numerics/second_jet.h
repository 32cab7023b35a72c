// Dual numbers of second order: a value with its first and second derivatives in N directions.
//
// A Jet of Jets (jet.h) has the same derivatives, in (N + 1)^2 numbers of which many are equal.
// Here those of a pair of directions are kept once, 1 + N + N (N + 1)/2 numbers in all, and a
// product or a function evaluates nothing twice:
//
//   (x y)_ij = x_ij y + x y_ij + x_i y_j + x_j y_i,      f(x)_ij = f'(x) x_ij + f''(x) x_i x_j.
//
// f' and f'' are those that Jets of one direction find, so that no derivative is written down
// again. On eight scenes the derivatives of a discrete Lagrangian, of both orders, take 0.36
// (satellite) to 0.8 (engel) of the time that they take where those of second order are found on
// Jets of Jets, column by column.
//
// T is a real type or a Pack.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <type_traits>

#include "carnot/numerics/jet.h"
#include "carnot/numerics/scalar.h"

namespace carnot {

// A value with the derivatives of it.
template <class T, int N>
struct SecondJet {
  using Scalar = T;
  static constexpr int kDirections = N;
  static constexpr int kPairs = N * (N + 1) / 2;

  T a;                      // the value
  std::array<T, N> v;       // its derivatives
  std::array<T, kPairs> w;  // those of second order: of (0, 0), (1, 0), (1, 1), (2, 0), ...

  SecondJet() : SecondJet(T(0)) {}
  // A constant.
  SecondJet(const T& value) : a(value) {
    for (int i = 0; i < N; ++i) v[i] = T(0);
    for (int i = 0; i < kPairs; ++i) w[i] = T(0);
  }
  template <class Number>
  requires(std::is_arithmetic_v<Number> && !std::is_same_v<Number, T>) SecondJet(Number value)
      : SecondJet(T(value)) {}
  // The variable of direction k.
  SecondJet(const T& value, int k) : SecondJet(value) { v[k] = T(1); }

  // The derivative in direction i is first(i), the one in i and j <= i is second(pair, i, j).
  template <class First, class Second>
  [[gnu::always_inline]] static SecondJet of(const T& value,
                                             const First& first,
                                             const Second& second) {
    SecondJet jet{Uninitialized{}};
    jet.a = value;
    for (int i = 0; i < N; ++i) jet.v[i] = first(i);
    for (int i = 0, pair = 0; i < N; ++i) {
      for (int j = 0; j <= i; ++j, ++pair) jet.w[pair] = second(pair, i, j);
    }
    return jet;
  }
  // Linear in the derivatives of x.
  [[gnu::always_inline]] static SecondJet scaled(const T& value,
                                                 const T& slope,
                                                 const SecondJet& x) {
    return of(
        value,
        [&](int i) { return slope * x.v[i]; },
        [&](int pair, int /*i*/, int /*j*/) { return slope * x.w[pair]; });
  }

 private:
  struct Uninitialized {};
  explicit SecondJet(Uninitialized /*values*/) {}
};

template <class T, int N>
struct RealOf<SecondJet<T, N>> : RealOf<T> {};
template <class T, int N>
auto value_of(const SecondJet<T, N>& x) {
  return value_of(x.a);
}

// f(x), where f is known on Jets.
template <class T, int N, class F>
SecondJet<T, N> lifted(const SecondJet<T, N>& x, const F& f) {
  using Inner = Jet<T, 1>;
  const Jet<Inner, 1> y = f(Jet<Inner, 1>(Inner(x.a, 0), 0));
  const T& slope = y.a.v[0];
  const T& curvature = y.v[0].v[0];
  return SecondJet<T, N>::of(
      y.a.a,
      [&](int i) { return slope * x.v[i]; },
      [&](int pair, int i, int j) { return slope * x.w[pair] + curvature * (x.v[i] * x.v[j]); });
}
// f(x, y), where f is known on Jets.
template <class T, int N, class F>
SecondJet<T, N> lifted(const SecondJet<T, N>& x, const SecondJet<T, N>& y, const F& f) {
  using Inner = Jet<T, 2>;
  using Outer = Jet<Inner, 2>;
  const Outer z = f(Outer(Inner(x.a, 0), 0), Outer(Inner(y.a, 1), 1));
  const T& by_x = z.a.v[0];
  const T& by_y = z.a.v[1];
  const T& by_xx = z.v[0].v[0];
  const T& by_xy = z.v[0].v[1];
  const T& by_yy = z.v[1].v[1];
  return SecondJet<T, N>::of(
      z.a.a,
      [&](int i) { return by_x * x.v[i] + by_y * y.v[i]; },
      [&](int pair, int i, int j) {
        return by_x * x.w[pair] + by_y * y.w[pair] + by_xx * (x.v[i] * x.v[j]) +
               by_xy * (x.v[i] * y.v[j] + x.v[j] * y.v[i]) + by_yy * (y.v[i] * y.v[j]);
      });
}

template <class T, int N>
SecondJet<T, N> operator-(const SecondJet<T, N>& x) {
  return SecondJet<T, N>::scaled(-x.a, T(-1), x);
}

template <class T, int N>
SecondJet<T, N> operator+(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return SecondJet<T, N>::of(
      x.a + y.a,
      [&](int i) { return x.v[i] + y.v[i]; },
      [&](int pair, int /*i*/, int /*j*/) { return x.w[pair] + y.w[pair]; });
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator+(SecondJet<T, N> x, const S& s) {
  x.a += T(s);
  return x;
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator+(const S& s, const SecondJet<T, N>& x) {
  return x + s;
}

template <class T, int N>
SecondJet<T, N> operator-(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return SecondJet<T, N>::of(
      x.a - y.a,
      [&](int i) { return x.v[i] - y.v[i]; },
      [&](int pair, int /*i*/, int /*j*/) { return x.w[pair] - y.w[pair]; });
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator-(SecondJet<T, N> x, const S& s) {
  x.a -= T(s);
  return x;
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator-(const S& s, const SecondJet<T, N>& x) {
  return SecondJet<T, N>::scaled(T(s) - x.a, T(-1), x);
}

template <class T, int N>
SecondJet<T, N> operator*(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return SecondJet<T, N>::of(
      x.a * y.a,
      [&](int i) { return x.v[i] * y.a + x.a * y.v[i]; },
      [&](int pair, int i, int j) {
        return x.w[pair] * y.a + x.a * y.w[pair] + (x.v[i] * y.v[j] + x.v[j] * y.v[i]);
      });
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator*(const SecondJet<T, N>& x, const S& s) {
  const T factor(s);
  return SecondJet<T, N>::scaled(x.a * factor, factor, x);
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator*(const S& s, const SecondJet<T, N>& x) {
  return x * s;
}

// With r = x/y, from x = r y.
template <class T, int N>
SecondJet<T, N> operator/(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  const T inverse = T(1) / y.a;
  const T ratio = x.a * inverse;
  std::array<T, N> slopes;
  for (int i = 0; i < N; ++i) slopes[i] = (x.v[i] - ratio * y.v[i]) * inverse;
  return SecondJet<T, N>::of(
      ratio,
      [&](int i) { return slopes[i]; },
      [&](int pair, int i, int j) {
        return (x.w[pair] - ratio * y.w[pair] - (slopes[i] * y.v[j] + slopes[j] * y.v[i])) *
               inverse;
      });
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator/(const SecondJet<T, N>& x, const S& s) {
  return x * (T(1) / T(s));
}
template <class T, int N, ConstantOf<T> S>
SecondJet<T, N> operator/(const S& s, const SecondJet<T, N>& x) {
  return lifted(x, [&](const auto& y) { return T(s) / y; });
}

template <class T, int N, class Y>
SecondJet<T, N>& operator+=(SecondJet<T, N>& x, const Y& y) {
  return x = x + y;
}
template <class T, int N, class Y>
SecondJet<T, N>& operator-=(SecondJet<T, N>& x, const Y& y) {
  return x = x - y;
}
template <class T, int N, class Y>
SecondJet<T, N>& operator*=(SecondJet<T, N>& x, const Y& y) {
  return x = x * y;
}
template <class T, int N, class Y>
SecondJet<T, N>& operator/=(SecondJet<T, N>& x, const Y& y) {
  return x = x / y;
}

// Comparisons are those of the values.
template <class T, int N>
auto operator<(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return x.a < y.a;
}
template <class T, int N, ConstantOf<T> S>
auto operator<(const SecondJet<T, N>& x, const S& s) {
  return x.a < T(s);
}
template <class T, int N, ConstantOf<T> S>
auto operator<(const S& s, const SecondJet<T, N>& x) {
  return T(s) < x.a;
}
template <class T, int N>
auto operator<=(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return x.a <= y.a;
}
template <class T, int N, ConstantOf<T> S>
auto operator<=(const SecondJet<T, N>& x, const S& s) {
  return x.a <= T(s);
}
template <class T, int N, ConstantOf<T> S>
auto operator<=(const S& s, const SecondJet<T, N>& x) {
  return T(s) <= x.a;
}
template <class T, int N, class Y>
auto operator>(const SecondJet<T, N>& x, const Y& y) {
  return y < x;
}
template <class T, int N, ConstantOf<T> S>
auto operator>(const S& s, const SecondJet<T, N>& x) {
  return x < s;
}
template <class T, int N, class Y>
auto operator>=(const SecondJet<T, N>& x, const Y& y) {
  return y <= x;
}
template <class T, int N, ConstantOf<T> S>
auto operator>=(const S& s, const SecondJet<T, N>& x) {
  return x <= s;
}
template <class T, int N>
bool operator==(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return x.a == y.a;
}
template <class T, int N, ConstantOf<T> S>
bool operator==(const SecondJet<T, N>& x, const S& s) {
  return x.a == T(s);
}

template <class T, int N>
SecondJet<T, N> abs(const SecondJet<T, N>& x) {
  return x.a < T(0) ? -x : x;
}
template <class T, int N>
SecondJet<T, N> sqrt(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return sqrt(y); });
}
template <class T, int N>
SecondJet<T, N> cbrt(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return cbrt(y); });
}
template <class T, int N>
SecondJet<T, N> exp(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return exp(y); });
}
template <class T, int N>
SecondJet<T, N> log(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return log(y); });
}
template <class T, int N>
SecondJet<T, N> sin(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return sin(y); });
}
template <class T, int N>
SecondJet<T, N> cos(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return cos(y); });
}
template <class T, int N>
SecondJet<T, N> tan(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return tan(y); });
}
template <class T, int N>
SecondJet<T, N> asin(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return asin(y); });
}
template <class T, int N>
SecondJet<T, N> acos(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return acos(y); });
}
template <class T, int N>
SecondJet<T, N> atan(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return atan(y); });
}
template <class T, int N>
SecondJet<T, N> sinh(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return sinh(y); });
}
template <class T, int N>
SecondJet<T, N> cosh(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return cosh(y); });
}
template <class T, int N>
SecondJet<T, N> tanh(const SecondJet<T, N>& x) {
  return lifted(x, [](const auto& y) { return tanh(y); });
}
// The angle of (x, y).
template <class T, int N>
SecondJet<T, N> atan2(const SecondJet<T, N>& y, const SecondJet<T, N>& x) {
  return lifted(y, x, [](const auto& b, const auto& a) { return atan2(b, a); });
}
template <class T, int N>
SecondJet<T, N> hypot(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return lifted(x, y, [](const auto& a, const auto& b) { return hypot(a, b); });
}
// A constant power.
template <class T, int N, class Number>
requires std::is_arithmetic_v<Number> SecondJet<T, N> pow(const SecondJet<T, N>& x,
                                                          Number exponent) {
  return lifted(x, [&](const auto& y) { return pow(y, exponent); });
}
// x^y for x > 0.
template <class T, int N>
SecondJet<T, N> pow(const SecondJet<T, N>& x, const SecondJet<T, N>& y) {
  return exp(y * log(x));
}
template <class T, int N>
auto isfinite(const SecondJet<T, N>& x) {
  using std::isfinite;
  return isfinite(x.a);
}
template <class T, int N>
auto isnan(const SecondJet<T, N>& x) {
  using std::isnan;
  return isnan(x.a);
}

}  // namespace carnot

namespace Eigen {

template <class T, int N>
struct NumTraits<carnot::SecondJet<T, N>> : NumTraits<T> {
  using Real = carnot::SecondJet<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { IsComplex = 0, IsInteger = 0, RequireInitialization = 1 };
};

// A SecondJet times a plain value, in Eigen's expressions.
template <class BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<carnot::SecondJet<T, N>, T, BinaryOp> {
  using ReturnType = carnot::SecondJet<T, N>;
};
template <class BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<T, carnot::SecondJet<T, N>, BinaryOp> {
  using ReturnType = carnot::SecondJet<T, N>;
};

}  // namespace Eigen
