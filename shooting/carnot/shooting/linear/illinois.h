// A zero of a function between two places where its signs differ.
//
// Secants, each through the newest place and the one on the other side. A place that stays counts
// half from then on, or it would stay for ever (the Illinois method: Dowell & Jarratt, BIT 11,
// 1971). The order is 1.44, and the zero stays between the two.
#pragma once

#include <cmath>

namespace carnot::internal {

// With the values at a and b, which have different signs, f(x) gives an optional value at x. Ends
// where the places are no further apart than `enough`, and where there is no value. Returns the
// place that was evaluated last, b at first.
template <class F>
double illinois(double a, double at_a, double b, double at_b, double enough, const F& f) {
  constexpr int kIterations = 50;
  for (int i = 0; i < kIterations && std::abs(b - a) > enough && at_b != at_a; ++i) {
    const double x = b - at_b * (b - a) / (at_b - at_a);
    if (x == b) break;
    const auto at_x = f(x);
    if (!at_x) break;
    if (*at_x * at_b > 0) {
      at_a *= 0.5;
    } else {
      a = b;
      at_a = at_b;
    }
    const double change = std::abs(x - b);
    b = x;
    at_b = *at_x;
    if (change <= enough || at_b == 0) break;
  }
  return b;
}

}  // namespace carnot::internal
