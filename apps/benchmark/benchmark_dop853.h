// DOP853 with its own choice of steps, for one trajectory in double: the contrast of `carnot
// benchmark`, as fast as an explicit method gets when the compiler sees all of it.
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, 2nd ed. (1993): the method in II.10, the step
// control in II.4, its constants those of the code DOP853. The error estimate weighs the embedded
// methods of order 5 and 3: with e5, e3 scaled by tolerance (1 + |z|),
//
//   err = h |e5|^2 / sqrt(n (|e5|^2 + 0.01 |e3|^2)),
//
// and the next step is h times 0.9 err^(-1/8), within [1/3, 6]. No dense output, no test for
// stiffness.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "carnot/tableau/dop853_embedded.h"

namespace carnot::apps {

struct Dop853Report {
  bool completed = false;
  long steps = 0;
  long rejected = 0;
  long evaluations = 0;
};

// Rate: kSize and void operator()(const double* z, double* f) const; autonomous.
template <class Rate>
class AdaptiveDop853 {
 public:
  static constexpr int n = Rate::kSize;

  AdaptiveDop853(const Rate& rate, double tolerance) : rate_(rate), tolerance_(tolerance) {}

  // Advances z over `duration` > 0; observe(z) after each accepted step. On failure, which is too
  // many steps or a step too short to matter, z is the last good point.
  template <class Observe>
  Dop853Report run(double duration, double* z, Observe&& observe) {
    Dop853Report report;
    Point y;
    std::copy_n(z, n, y.begin());
    evaluate(y, 0, report);
    double t = 0;
    double h = first_step(y, duration, report);
    bool rejected = false;
    while (report.steps < kMostSteps) {
      const bool last = t + 1.01 * h >= duration;  // no tiny step at the end
      if (last) h = duration - t;
      if (!(h > kShortest * duration)) return report;
      stages(y, h, report, std::make_index_sequence<dop853::kStages - 1>{});
      Point next;
      combine<dop853::kStages>(y, h, next);
      const double error = h * error_of(y, next);
      // 1/8 of the order, by roots; NaN counts as too large.
      double factor = 0.9 / std::sqrt(std::sqrt(std::sqrt(error)));
      if (!(error <= 1)) {
        h *= factor >= kLeast ? factor : kLeast;
        rejected = true;
        ++report.rejected;
        continue;
      }
      ++report.steps;
      t += h;
      y = next;
      std::copy_n(y.begin(), n, z);
      observe(static_cast<const double*>(z));
      if (last) {
        report.completed = true;
        return report;
      }
      evaluate(y, 0, report);
      factor = std::clamp(factor, kLeast, kMost);
      h *= rejected ? std::min(factor, 1.0) : factor;
      rejected = false;
    }
    return report;
  }

  Dop853Report run(double duration, double* z) {
    return run(duration, z, [](const double*) {});
  }

 private:
  using Point = std::array<double, n>;
  static constexpr long kMostSteps = 10000000;
  static constexpr double kShortest = 1e-14;
  static constexpr double kLeast = 1.0 / 3;
  static constexpr double kMost = 6;

  void evaluate(const Point& y, int stage, Dop853Report& report) {
    rate_(y.data(), k_[stage].data());
    ++report.evaluations;
  }

  // sum_j w_j k_j.
  template <const dop853::Weights& w>
  [[nodiscard]] double weighted(int i) const {
    return dop853::weighted<w>(0.0, [&](int j) { return k_[j][i]; });
  }

  // y + h sum_j a_ij k_j.
  template <int row>
  void combine(const Point& y, double h, Point& out) const {
    for (int i = 0; i < n; ++i) out[i] = y[i] + h * weighted<dop853::kRow<row>>(i);
  }

  template <std::size_t... i>
  void stages(const Point& y, double h, Dop853Report& report, std::index_sequence<i...> /*all*/) {
    Point u;
    ((combine<i + 1>(y, h, u), evaluate(u, i + 1, report)), ...);
  }

  [[nodiscard]] double scale(double a, double b) const {
    return tolerance_ * (1 + std::max(std::abs(a), std::abs(b)));
  }

  // err / h of the head of this file.
  [[nodiscard]] double error_of(const Point& y, const Point& next) const {
    double five = 0;
    double three = 0;
    for (int i = 0; i < n; ++i) {
      const double weight = 1 / scale(y[i], next[i]);
      const double e5 = weighted<dop853::kError5>(i) * weight;
      const double e3 = weighted<dop853::kError3>(i) * weight;
      five += e5 * e5;
      three += e3 * e3;
    }
    const double sum = five + 0.01 * three;
    return sum > 0 ? five / std::sqrt(n * sum) : 0;
  }

  // II.4: from the sizes of y, y' and y''.
  double first_step(const Point& y, double duration, Dop853Report& report) {
    double d0 = 0;
    double d1 = 0;
    for (int i = 0; i < n; ++i) {
      d0 += std::pow(y[i] / scale(y[i], 0), 2);
      d1 += std::pow(k_[0][i] / scale(y[i], 0), 2);
    }
    const double guess = d0 < 1e-10 || d1 < 1e-10 ? 1e-6 : 0.01 * std::sqrt(d0 / d1);
    const double h = std::min(guess, duration);
    Point u;
    for (int i = 0; i < n; ++i) u[i] = y[i] + h * k_[0][i];
    evaluate(u, 1, report);
    double d2 = 0;
    for (int i = 0; i < n; ++i) d2 += std::pow((k_[1][i] - k_[0][i]) / scale(y[i], 0), 2);
    const double steepest = std::max(std::sqrt(d1), std::sqrt(d2) / h);
    const double by_order =
        steepest <= 1e-15 ? std::max(1e-6, 1e-3 * h) : std::pow(0.01 / steepest, 1.0 / 8);
    return std::min({100 * h, by_order, duration});
  }

  Rate rate_;
  double tolerance_;
  std::array<Point, dop853::kStages> k_{};
};

}  // namespace carnot::apps
