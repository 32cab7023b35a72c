// What the templated formulas ask of a scalar: constants, the underlying value, the round-off unit.
//
// A formula is written once and runs on double, long double, a quad type and (nested) Jets.
#pragma once

#include <limits>
#include <type_traits>

#include "carnot/numerics/jet.h"

namespace carnot {

template <class T>
struct IsJet : std::false_type {};
template <class T, int N>
struct IsJet<Jet<T, N>> : std::true_type {};
template <class T>
inline constexpr bool kIsJet = IsJet<T>::value;

// The real type at the bottom of a tower of Jets.
template <class T>
struct RealOf {
  using type = T;
};
template <class T, int N>
struct RealOf<Jet<T, N>> : RealOf<T> {};
template <class T>
using Real = typename RealOf<T>::type;

// A number that does not depend on the variables of differentiation.
template <class T, class U>
constexpr T constant(const U& value) {
  if constexpr (kIsJet<T>) {
    return T(constant<typename T::Scalar>(value));
  } else {
    return T(value);
  }
}

// The value without its derivatives.
template <class T>
auto value_of(const T& x) {
  if constexpr (kIsJet<T>) {
    return value_of(x.a);
  } else {
    return x;
  }
}

// A comparison that must hold; of packs (pack.h) in every lane.
constexpr bool all(bool holds) { return holds; }

// The larger and the smaller of two numbers; not a number where one of them is none, as the
// operations of these names in IEEE 754-2019. std::max keeps the first one there.
template <class T>
constexpr T maximum(const T& a, const T& b) {
  return a >= b || a != a ? a : b;
}
template <class T>
constexpr T minimum(const T& a, const T& b) {
  return a <= b || a != a ? a : b;
}

// Unit round-off distance: the gap between 1 and the next number.
template <class T>
constexpr Real<T> epsilon() {
  return std::numeric_limits<Real<T>>::epsilon();
}

}  // namespace carnot
