// Stumpff functions c_k(s) = sum_j (-s)^j / (2j + k)!, entire in s.
//
// c_0(r^2) = cos r and c_1(r^2) = sin(r)/r, so a potential that is even in a distance r can be
// written in r^2 and stays smooth at r = 0, where sqrt has no derivative. From the series
//
//   s c_{k+2} = 1/k! - c_k,      dc_k/ds = (k c_{k+2} - c_{k+1}) / 2.
//
// Source: Stiefel & Scheifele, Linear and Regular Celestial Mechanics (1971), section 11.
#pragma once

#include <array>
#include <cmath>

#include "carnot/numerics/pack.h"
#include "carnot/numerics/scalar.h"
#include "carnot/numerics/second_jet.h"

namespace carnot {

// The series of c_k, which reaches round-off for s <= kNearStumpff, summed in pairs, pairs of pairs
// and so on (Estrin), so that the chain is short.
inline constexpr double kNearStumpff = 10;

template <int k, class T>
T stumpff_series(const T& s) {
  constexpr int kTerms = 16;
  constexpr auto kCoefficients = [] {
    std::array<double, kTerms> c{};
    double factorial = 1;
    for (int i = 2; i <= k; ++i) factorial *= i;
    for (int j = 0; j < kTerms; ++j) {
      c[j] = (j % 2 == 0 ? 1 : -1) / factorial;
      factorial *= (2.0 * j + k + 1) * (2.0 * j + k + 2);
    }
    return c;
  }();
  std::array<T, kTerms> sum;
  for (int j = 0; j < kTerms; ++j) sum[j] = T(kCoefficients[j]);
  T power = s;
  for (int terms = kTerms / 2; terms > 0; terms /= 2) {
    for (int j = 0; j < terms; ++j) sum[j] = sum[2 * j + 1] * power + sum[2 * j];
    power = power * power;
  }
  return sum[0];
}

// On packs. The way of a lane does not depend on the others; one that none goes is left out.
template <int k, class T>
T far_stumpff(const T& s) {
  const T root = sqrt(max(s, T(1e-300)));
  if constexpr (k == 0) {
    return cos(root);
  } else if constexpr (k == 1) {
    return sin(root) / root;
  } else {
    double factorial = 1;
    for (int i = 2; i <= k - 2; ++i) factorial *= i;
    return (T(1 / factorial) - far_stumpff<k - 2>(s)) / max(s, T(1));
  }
}
template <int k, class T>
T packed_stumpff(const T& s) {
  const T limit(kNearStumpff);
  if (all(s <= limit)) return stumpff_series<k>(s);
  if (all(s > limit)) return far_stumpff<k>(s);
  return select(s <= limit, stumpff_series<k>(min(s, limit)), far_stumpff<k>(s));
}

// c_k(s) for s >= 0. Values to a few units of round-off; on Jets by the derivative above.
template <int k, class T>
T stumpff(const T& s) {
  if constexpr (kIsJet<T>) {
    const auto derivative =
        constant<typename T::Scalar>(0.5) *
        (constant<typename T::Scalar>(k) * stumpff<k + 2>(s.a) - stumpff<k + 1>(s.a));
    return T(stumpff<k>(s.a), derivative * s.v);
  } else if constexpr (kIsPack<T>) {
    return packed_stumpff<k>(s);
  } else {
    using std::abs, std::cos, std::sin, std::sqrt;
    if (s < T(1)) {  // here recursion would cancel
      T term(1);
      for (int i = 2; i <= k; ++i) term /= T(i);
      T sum = term;
      for (int j = 1; abs(term) > epsilon<T>() * abs(sum) && j < 40; ++j) {
        term *= -s / T((2 * j + k - 1) * (2 * j + k));
        sum += term;
      }
      return sum;
    }
    if constexpr (k == 0) {
      return cos(sqrt(s));
    } else if constexpr (k == 1) {
      const T root = sqrt(s);
      return sin(root) / root;
    } else {
      T inverse_factorial(1);
      for (int i = 2; i <= k - 2; ++i) inverse_factorial /= T(i);
      return (inverse_factorial - stumpff<k - 2>(s)) / s;
    }
  }
}
template <int k, class T, int N>
SecondJet<T, N> stumpff(const SecondJet<T, N>& s) {
  return lifted(s, [](const auto& x) { return stumpff<k>(x); });
}

}  // namespace carnot
