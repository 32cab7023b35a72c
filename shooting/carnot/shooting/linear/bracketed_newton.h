// A zero of a function with a derivative between two places where its signs differ.
//
// The inverse function through two places, with its slopes, is a cubic, and its value at zero is
// the next place (inverse Hermite interpolation). Its order is 1 + sqrt 3 = 2.7: the new error is
// about the square of the product of the two before. Where this place is not between the two ends,
// or the step there is not half as long as the one before, Newton's method is tried, and then the
// middle of the ends takes its place. So the zero stays between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

namespace carnot::internal {

struct ValueAndSlope {
  double value = 0;
  double slope = 0;
};

// Where the cubic x(y) with x(f_a) = a, x(f_b) = b and with the slopes 1/f'_a, 1/f'_b is at y = 0.
inline double inverse_cubic_at_zero(double a, ValueAndSlope f_a, double b, ValueAndSlope f_b) {
  const double width = f_b.value - f_a.value;
  const double s = -f_a.value / width;  // of the way from f_a to f_b
  const double chord = b - a;
  const double c = width / f_a.slope - chord;
  const double d = chord - width / f_b.slope;
  return a + s * (chord + (1 - s) * ((1 - s) * c + s * d));
}

// With the values at a and b, which have different signs, f(x) gives an optional ValueAndSlope at
// x. Ends at a place from which a step of Newton's method is no longer than `near`; where there is
// no value; and after a hundred of them. Returns the place that was evaluated last, b where there
// was none.
template <class F>
double bracketed_newton(
    double a, ValueAndSlope at_a, double b, ValueAndSlope at_b, double near, const F& f) {
  constexpr int kMost = 100;
  double x = b;
  double step = std::abs(b - a);
  // The last place, and the one before.
  double before = a;
  ValueAndSlope at_before = at_a;
  ValueAndSlope at_x = at_b;
  const auto fits = [&](double place) {
    return std::min(a, b) < place && place < std::max(a, b) && std::abs(place - x) < 0.5 * step;
  };
  double next = inverse_cubic_at_zero(a, at_a, b, at_b);
  if (!(std::min(a, b) < next && next < std::max(a, b))) {
    next = b - at_b.value * (b - a) / (at_b.value - at_a.value);
  }
  for (int i = 0; i < kMost; ++i) {
    const auto at_next = f(next);
    if (!at_next) break;
    before = std::exchange(x, next);
    at_before = std::exchange(at_x, *at_next);
    const double newton = x - at_x.value / at_x.slope;
    if (at_x.value == 0 || std::abs(newton - x) <= near) break;
    (at_x.value * at_b.value > 0 ? b : a) = x;
    next = inverse_cubic_at_zero(before, at_before, x, at_x);
    if (!fits(next)) next = newton;
    if (!fits(next)) next = 0.5 * (a + b);
    if (next == x) break;
    step = std::abs(next - x);
  }
  return x;
}

}  // namespace carnot::internal
