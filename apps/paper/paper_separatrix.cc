#include "paper/paper_separatrix.h"

#include <algorithm>
#include <cmath>

namespace carnot::apps {
namespace {

constexpr int kIntervals = 4000;  // of length < 0.03 in the smooth variables used here

// Simpson's rule.
template <class F>
double integral(const F& f, double from, double to) {
  const double h = (to - from) / kIntervals;
  double sum = f(from) + f(to);
  for (int i = 1; i < kIntervals; ++i) sum += (i % 2 == 0 ? 2 : 4) * f(from + i * h);
  return sum * h / 3;
}

double square(double x) { return x * x; }

// d t / d y on the separatrix, where y = log tan(x/2), so that dx = sin(x) dy, cos(x) = -tanh(y).
double separatrix_slowness(const CircleMotion& m, double y) {
  const double s = square(std::tanh(y));  // sin^2 delta = cos^2 x
  return std::sqrt(m.beta * (square(m.length) + m.alpha * s) / m.total()) / (m.turn * m.length);
}

}  // namespace

double CircleMotion::growth_rate() const { return turn * length * std::sqrt(kappa()); }

double separatrix_time(const CircleMotion& motion, double from, double to) {
  const auto y = [](double x) { return std::log(std::tan(x / 2)); };
  return integral([&](double at) { return separatrix_slowness(motion, at); }, y(from), y(to));
}

// With c = sin(x), c0 its value at the turning point x0, E - f (P^2 - 2 beta E) is proportional to
// c^2 - c0^2. E - a^2 S/2 = -w^2 l^2 c^2 / (2 (l^2 + alpha)(l^2 + alpha s)) at the start gives
// c0^2 = -2 S (E - a^2 S/2) / (P^2 - 2 (alpha + beta) E) without cancellation. Up to x = pi/6 the
// variable c = c0 cosh(v) takes away the root at x0, beyond it x itself will do.
double halfway_time(const CircleMotion& motion, double perturbation) {
  const double l2 = square(motion.length);
  const double alpha = motion.alpha;
  const double beta = motion.beta;
  const double whole = motion.turn * motion.total();  // P
  const double w = motion.turn * (l2 + alpha);
  const double sine = std::sin(perturbation);
  const double deficit =
      square(w * sine) * l2 / (2 * (l2 + alpha) * (l2 + alpha * (1 - square(sine))));
  const double energy = motion.turn * whole / 2 - deficit;
  const double scale = square(whole) - 2 * (alpha + beta) * energy;
  const double c0 = std::sqrt(2 * motion.total() * deficit / scale);
  const auto slowness = [&](double c) {  // times sqrt(c^2 - c0^2)
    return std::sqrt(beta * (l2 + alpha * (1 - c * c)) / scale);
  };
  // At the start delta' = a l^2 sin^2(x)/(l^2 + alpha s), and sinh(v) from it without cancellation.
  const double rate = motion.turn * l2 * square(sine) / (l2 + alpha * (1 - square(sine)));
  const double first = std::asinh(rate * slowness(sine) / c0);
  const double split = std::max(0.5, std::sqrt(sine));
  const double near = integral(
      [&](double v) {
        const double c = c0 * std::cosh(v);
        return slowness(c) / std::sqrt(1 - c * c);
      },
      first,
      std::acosh(split / c0));
  const double far = integral(
      [&](double x) { return slowness(std::sin(x)) / std::sqrt(square(std::sin(x)) - c0 * c0); },
      std::asin(split),
      std::acos(0.0));
  return near + far;
}

// The rear wheel moves at u cos(delta) along theta, u = w l sin(delta)/(l^2 + alpha s) being the
// speed of the front wheel; theta' = u sin(delta)/l. Counted from the middle, y = 0, theta is odd
// and u cos(delta) is odd, so only their products with sin(theta) are left.
double centre_shift(const CircleMotion& motion) {
  constexpr double kEnd = 40;  // exp(-40) of the way is left
  const double l2 = square(motion.length);
  const auto front_speed = [&](double y) {  // over sin(delta), where delta = pi/2 + x
    const double sine2 = square(std::tanh(y));
    const double rate = 1 / (std::cosh(y) * separatrix_slowness(motion, y));  // delta'
    const double f2 = sine2 / (l2 + motion.alpha * sine2);                    // 2 f
    const double w = (motion.turn * motion.total() / motion.beta - rate) / (1 / motion.beta + f2);
    return w * motion.length / (l2 + motion.alpha * sine2);
  };
  const double h = kEnd / kIntervals;
  double theta = 0;
  double shift = 0;
  const auto theta_rate = [&](double y) {  // d theta / d y
    return front_speed(y) * square(std::tanh(y)) / motion.length * separatrix_slowness(motion, y);
  };
  const auto shift_rate = [&](double y, double at) {  // u cos(delta) sin(theta) dt/dy
    return front_speed(y) * std::tanh(y) / std::cosh(y) * std::sin(at) *
           separatrix_slowness(motion, y);
  };
  for (int i = 0; i < kIntervals; ++i) {  // the midpoint rule, its theta by the trapezoidal rule
    const double y = i * h;
    const double middle = theta + h / 4 * (theta_rate(y) + theta_rate(y + h / 2));
    shift += h * shift_rate(y + h / 2, middle);
    theta += h / 6 * (theta_rate(y) + 4 * theta_rate(y + h / 2) + theta_rate(y + h));
  }
  return 2 * std::abs(shift);
}

}  // namespace carnot::apps
