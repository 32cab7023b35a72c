// A zero of a function with a derivative between two places where its signs differ.
//
// Newton's method from the place that was evaluated last; where its step leaves the places between
// which the zero lies, or is not half as long as the one before, the middle of them takes its
// place. So the zero stays between the two.
#pragma once

#include <algorithm>
#include <cmath>

namespace carnot::internal {

struct ValueAndSlope {
  double value = 0;
  double slope = 0;
};

// With the values at a and b, which have different signs, f(x) gives an optional ValueAndSlope at
// x. Begins with a secant. Ends at a place that a step of Newton's method no longer than `near` led
// to, since what is left of it is of the order of the square of that step; where there is no value;
// and after a hundred of them. Returns the place that was evaluated last, b where there was none.
template <class F>
double bracketed_newton(double a, double at_a, double b, double at_b, double near, const F& f) {
  constexpr int kMost = 100;
  double x = b;
  double next = b - at_b * (b - a) / (at_b - at_a);
  double step = std::abs(b - a);
  bool newton = false;
  for (int i = 0; i < kMost; ++i) {
    const auto at_next = f(next);
    if (!at_next) break;
    x = next;
    const double value = at_next->value;
    if (value == 0 || (newton && step <= near)) break;
    (value * at_b > 0 ? b : a) = x;
    next = x - value / at_next->slope;
    newton = std::min(a, b) < next && next < std::max(a, b) && std::abs(next - x) < 0.5 * step;
    if (!newton) next = 0.5 * (a + b);
    if (next == x) break;
    step = std::abs(next - x);
  }
  return x;
}

}  // namespace carnot::internal
