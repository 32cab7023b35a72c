// The weights of DOP853 with its two embedded results, of order 5 and 3, for adaptive steps: known
// to the compiler, so that those which vanish cost nothing.
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.10, and the code that goes with it.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "carnot/numerics/coefficients.h"
#include "carnot/tableau/dop853_tableau.h"

namespace carnot::dop853 {

inline constexpr int kStages = 12;
using Weights = std::array<double, kStages>;

consteval double number(std::string_view text) {
  return static_cast<double>(decimal<long double>(text));
}

// Row i of a_ij, from 0; row 12 is b.
inline constexpr std::array<Weights, kStages + 1> kA = [] {
  std::array<Weights, kStages + 1> a{};
  for (const Dop853Entry& entry : kDop853) {
    a[entry.i - 1][entry.j - 1] = static_cast<double>(decimal<long double>(entry.value));
  }
  return a;
}();

// Row i, as an object of its own: clang 14 takes no part of one as the argument of a template.
template <int i>
inline constexpr Weights kRow = kA[i];

// b minus the weights of order 5.
inline constexpr Weights kError5 = {number("0.01312004499419488073250102996"),
                                    0,
                                    0,
                                    0,
                                    0,
                                    number("-1.225156446376204440720569753"),
                                    number("-0.4957589496572501915214079952"),
                                    number("1.664377182454986536961530415"),
                                    number("-0.3503288487499736816886487290"),
                                    number("0.3341791187130174790297318841"),
                                    number("0.08192320648511571246570742613"),
                                    number("-0.02235530786388629525884427845")};

// b minus the weights of order 3.
inline constexpr Weights kError3 = [] {
  Weights e = kA[kStages];
  e[0] -= number("0.244094488188976377952755905512");
  e[8] -= number("0.733846688281611857361341741547");
  e[11] -= number("0.0220588235294117647058823529412");
  return e;
}();

// sum_j w_j term(j) over the weights that do not vanish.
template <const Weights& w, class Number, class Term>
[[gnu::always_inline]] inline Number weighted(Number sum, const Term& term) {
  const auto add = [&]<int j>(std::integral_constant<int, j> /*stage*/) {
    if constexpr (w[j] != 0) sum += Number(w[j]) * term(j);
  };
  const auto all = [&]<int... j>(std::integer_sequence<int, j...> /*stages*/) {
    (add(std::integral_constant<int, j>{}), ...);
  };
  all(std::make_integer_sequence<int, kStages>{});
  return sum;
}

}  // namespace carnot::dop853
