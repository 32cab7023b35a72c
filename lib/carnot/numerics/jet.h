// Dual numbers: a value with its derivatives in N directions.
//
// With e_i e_j = 0 a function evaluates at x + sum_i v_i e_i to f(x) + sum_i f'(x) v_i e_i, since
// every further term of its series has a product of two e's. So a formula that is written for any
// scalar gives its exact derivatives where it is evaluated on Jets, at round-off and without steps
// to choose:
//
//   (a + u e)(b + v e)  = a b + (a v + b u) e,      1/(b + v e) = 1/b - v/b^2 e,
//   f(a + u e)          = f(a) + f'(a) u e.
//
// T is a real type, a Pack, or a Jet itself, for derivatives of second order. Numbers of C++ mix
// with Jets of any depth: 0.5 * x.
//
// Ceres has a class of the same name and the same formulas. This one is written in loops instead of
// Eigen's expressions, which a compiler has to take apart again for each type and each operation.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

namespace carnot {

// sin x and cos x; packs (pack.h) have both for little more than one of them.
template <class T>
struct SineAndCosine {
  T sine;
  T cosine;
};
template <class T>
SineAndCosine<T> sine_and_cosine(const T& x) {
  using std::cos, std::sin;
  return {sin(x), cos(x)};
}

// A value with the derivatives of it.
template <class T, int N>
struct Jet {
  using Scalar = T;
  static constexpr int kDirections = N;

  T a;                       // the value
  Eigen::Matrix<T, N, 1> v;  // its derivatives

  Jet() : Jet(T(0)) {}
  // NOLINTBEGIN(modernize-pass-by-value): to move a number is to copy it
  Jet(const T& value, const Eigen::Matrix<T, N, 1>& slopes) : a(value), v(slopes) {}
  // A constant.
  Jet(const T& value) : a(value) {
    for (int i = 0; i < N; ++i) v.data()[i] = T(0);
  }
  // NOLINTEND(modernize-pass-by-value)
  template <class Number>
  requires(std::is_arithmetic_v<Number> && !std::is_same_v<Number, T>) Jet(Number value)
      : Jet(T(value)) {}
  // The variable of direction k.
  Jet(const T& value, int k) : Jet(value) { v.data()[k] = T(1); }

  // The derivative in direction i is slope(i).
  template <class Slope>
  [[gnu::always_inline]] static Jet of(const T& value, const Slope& slope) {
    Jet jet;
    jet.a = value;
    T* const to = jet.v.data();
    for (int i = 0; i < N; ++i) to[i] = slope(i);
    return jet;
  }
  // f(x) from its value and its derivative at x.a.
  [[gnu::always_inline]] static Jet chain(const T& value, const T& derivative, const Jet& x) {
    const T* const u = x.v.data();
    return of(value, [&](int i) { return u[i] * derivative; });
  }
  // f(x, y) from its value and its derivatives at x.a and y.a.
  [[gnu::always_inline]] static Jet chain(
      const T& value, const T& by_x, const Jet& x, const T& by_y, const Jet& y) {
    const T* const u = x.v.data();
    const T* const w = y.v.data();
    return of(value, [&](int i) { return by_x * u[i] + by_y * w[i]; });
  }
};

// What mixes with a Jet: a value of its type, or a number of C++.
template <class S, class T>
concept ConstantOf = std::is_same_v<S, T> || std::is_arithmetic_v<S>;

template <class T, int N>
Jet<T, N> operator-(const Jet<T, N>& x) {
  const T* const u = x.v.data();
  return Jet<T, N>::of(-x.a, [&](int i) { return -u[i]; });
}

template <class T, int N>
Jet<T, N> operator+(const Jet<T, N>& x, const Jet<T, N>& y) {
  const T* const u = x.v.data();
  const T* const w = y.v.data();
  return Jet<T, N>::of(x.a + y.a, [&](int i) { return u[i] + w[i]; });
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator+(const Jet<T, N>& x, const S& s) {
  return {x.a + T(s), x.v};
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator+(const S& s, const Jet<T, N>& x) {
  return {T(s) + x.a, x.v};
}

template <class T, int N>
Jet<T, N> operator-(const Jet<T, N>& x, const Jet<T, N>& y) {
  const T* const u = x.v.data();
  const T* const w = y.v.data();
  return Jet<T, N>::of(x.a - y.a, [&](int i) { return u[i] - w[i]; });
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator-(const Jet<T, N>& x, const S& s) {
  return {x.a - T(s), x.v};
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator-(const S& s, const Jet<T, N>& x) {
  const T* const u = x.v.data();
  return Jet<T, N>::of(T(s) - x.a, [&](int i) { return -u[i]; });
}

template <class T, int N>
Jet<T, N> operator*(const Jet<T, N>& x, const Jet<T, N>& y) {
  return Jet<T, N>::chain(x.a * y.a, y.a, x, x.a, y);
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator*(const Jet<T, N>& x, const S& s) {
  const T factor(s);
  return Jet<T, N>::chain(x.a * factor, factor, x);
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator*(const S& s, const Jet<T, N>& x) {
  return x * s;
}

template <class T, int N>
Jet<T, N> operator/(const Jet<T, N>& x, const Jet<T, N>& y) {
  const T* const u = x.v.data();
  const T* const w = y.v.data();
  const T inverse = T(1) / y.a;
  const T ratio = x.a * inverse;
  return Jet<T, N>::of(ratio, [&](int i) { return (u[i] - ratio * w[i]) * inverse; });
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator/(const Jet<T, N>& x, const S& s) {
  const T inverse = T(1) / T(s);
  return Jet<T, N>::chain(x.a * inverse, inverse, x);
}
template <class T, int N, ConstantOf<T> S>
Jet<T, N> operator/(const S& s, const Jet<T, N>& x) {
  const T numerator(s);
  return Jet<T, N>::chain(numerator / x.a, -numerator / (x.a * x.a), x);
}

template <class T, int N, class Y>
Jet<T, N>& operator+=(Jet<T, N>& x, const Y& y) {
  return x = x + y;
}
template <class T, int N, class Y>
Jet<T, N>& operator-=(Jet<T, N>& x, const Y& y) {
  return x = x - y;
}
template <class T, int N, class Y>
Jet<T, N>& operator*=(Jet<T, N>& x, const Y& y) {
  return x = x * y;
}
template <class T, int N, class Y>
Jet<T, N>& operator/=(Jet<T, N>& x, const Y& y) {
  return x = x / y;
}

// Comparisons are those of the values.
template <class T, int N>
auto operator<(const Jet<T, N>& x, const Jet<T, N>& y) {
  return x.a < y.a;
}
template <class T, int N, ConstantOf<T> S>
auto operator<(const Jet<T, N>& x, const S& s) {
  return x.a < T(s);
}
template <class T, int N, ConstantOf<T> S>
auto operator<(const S& s, const Jet<T, N>& x) {
  return T(s) < x.a;
}
template <class T, int N>
auto operator<=(const Jet<T, N>& x, const Jet<T, N>& y) {
  return x.a <= y.a;
}
template <class T, int N, ConstantOf<T> S>
auto operator<=(const Jet<T, N>& x, const S& s) {
  return x.a <= T(s);
}
template <class T, int N, ConstantOf<T> S>
auto operator<=(const S& s, const Jet<T, N>& x) {
  return T(s) <= x.a;
}
template <class T, int N, class Y>
auto operator>(const Jet<T, N>& x, const Y& y) {
  return y < x;
}
template <class T, int N, ConstantOf<T> S>
auto operator>(const S& s, const Jet<T, N>& x) {
  return x < s;
}
template <class T, int N, class Y>
auto operator>=(const Jet<T, N>& x, const Y& y) {
  return y <= x;
}
template <class T, int N, ConstantOf<T> S>
auto operator>=(const S& s, const Jet<T, N>& x) {
  return x <= s;
}
template <class T, int N>
bool operator==(const Jet<T, N>& x, const Jet<T, N>& y) {
  return x.a == y.a;
}
template <class T, int N, ConstantOf<T> S>
bool operator==(const Jet<T, N>& x, const S& s) {
  return x.a == T(s);
}

template <class T, int N>
Jet<T, N> abs(const Jet<T, N>& x) {
  return x.a < T(0) ? -x : x;
}
template <class T, int N>
Jet<T, N> sqrt(const Jet<T, N>& x) {
  using std::sqrt;
  const T root = sqrt(x.a);
  return Jet<T, N>::chain(root, T(1) / (T(2) * root), x);
}
template <class T, int N>
Jet<T, N> cbrt(const Jet<T, N>& x) {
  using std::cbrt;
  const T root = cbrt(x.a);
  return Jet<T, N>::chain(root, T(1) / (T(3) * (root * root)), x);
}
template <class T, int N>
Jet<T, N> exp(const Jet<T, N>& x) {
  using std::exp;
  const T power = exp(x.a);
  return Jet<T, N>::chain(power, power, x);
}
template <class T, int N>
Jet<T, N> log(const Jet<T, N>& x) {
  using std::log;
  return Jet<T, N>::chain(log(x.a), T(1) / x.a, x);
}
template <class T, int N>
SineAndCosine<Jet<T, N>> sine_and_cosine(const Jet<T, N>& x) {
  const auto of_value = sine_and_cosine(x.a);
  return {Jet<T, N>::chain(of_value.sine, of_value.cosine, x),
          Jet<T, N>::chain(of_value.cosine, -of_value.sine, x)};
}
template <class T, int N>
Jet<T, N> sin(const Jet<T, N>& x) {
  const auto of_value = sine_and_cosine(x.a);
  return Jet<T, N>::chain(of_value.sine, of_value.cosine, x);
}
template <class T, int N>
Jet<T, N> cos(const Jet<T, N>& x) {
  const auto of_value = sine_and_cosine(x.a);
  return Jet<T, N>::chain(of_value.cosine, -of_value.sine, x);
}
template <class T, int N>
Jet<T, N> tan(const Jet<T, N>& x) {
  using std::tan;
  const T value = tan(x.a);
  return Jet<T, N>::chain(value, T(1) + value * value, x);
}
template <class T, int N>
Jet<T, N> asin(const Jet<T, N>& x) {
  using std::asin, std::sqrt;
  return Jet<T, N>::chain(asin(x.a), T(1) / sqrt(T(1) - x.a * x.a), x);
}
template <class T, int N>
Jet<T, N> acos(const Jet<T, N>& x) {
  using std::acos, std::sqrt;
  return Jet<T, N>::chain(acos(x.a), T(-1) / sqrt(T(1) - x.a * x.a), x);
}
template <class T, int N>
Jet<T, N> atan(const Jet<T, N>& x) {
  using std::atan;
  return Jet<T, N>::chain(atan(x.a), T(1) / (T(1) + x.a * x.a), x);
}
template <class T, int N>
Jet<T, N> sinh(const Jet<T, N>& x) {
  using std::cosh, std::sinh;
  return Jet<T, N>::chain(sinh(x.a), cosh(x.a), x);
}
template <class T, int N>
Jet<T, N> cosh(const Jet<T, N>& x) {
  using std::cosh, std::sinh;
  return Jet<T, N>::chain(cosh(x.a), sinh(x.a), x);
}
template <class T, int N>
Jet<T, N> tanh(const Jet<T, N>& x) {
  using std::tanh;
  const T value = tanh(x.a);
  return Jet<T, N>::chain(value, T(1) - value * value, x);
}
// The angle of (x, y).
template <class T, int N>
Jet<T, N> atan2(const Jet<T, N>& y, const Jet<T, N>& x) {
  using std::atan2;
  const T inverse = T(1) / (x.a * x.a + y.a * y.a);
  return Jet<T, N>::chain(atan2(y.a, x.a), -y.a * inverse, x, x.a * inverse, y);
}
template <class T, int N>
Jet<T, N> hypot(const Jet<T, N>& x, const Jet<T, N>& y) {
  using std::hypot;
  const T length = hypot(x.a, y.a);
  return Jet<T, N>::chain(length, x.a / length, x, y.a / length, y);
}
// A constant power.
template <class T, int N, class Number>
requires std::is_arithmetic_v<Number> Jet<T, N> pow(const Jet<T, N>& x, Number exponent) {
  using std::pow;
  if (exponent == Number(0)) return Jet<T, N>(T(1));
  return Jet<T, N>::chain(pow(x.a, exponent), T(exponent) * pow(x.a, exponent - Number(1)), x);
}
// x^y for x > 0.
template <class T, int N>
Jet<T, N> pow(const Jet<T, N>& x, const Jet<T, N>& y) {
  return exp(y * log(x));
}
template <class T, int N>
auto isfinite(const Jet<T, N>& x) {
  using std::isfinite;
  return isfinite(x.a);
}
template <class T, int N>
auto isnan(const Jet<T, N>& x) {
  using std::isnan;
  return isnan(x.a);
}

}  // namespace carnot

namespace Eigen {

template <class T, int N>
struct NumTraits<carnot::Jet<T, N>> : NumTraits<T> {
  using Real = carnot::Jet<T, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { IsComplex = 0, IsInteger = 0, RequireInitialization = 1 };
};

// A Jet times a plain value, in Eigen's expressions.
template <class BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<carnot::Jet<T, N>, T, BinaryOp> {
  using ReturnType = carnot::Jet<T, N>;
};
template <class BinaryOp, class T, int N>
struct ScalarBinaryOpTraits<T, carnot::Jet<T, N>, BinaryOp> {
  using ReturnType = carnot::Jet<T, N>;
};

}  // namespace Eigen
