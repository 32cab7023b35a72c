// W trajectories side by side with the explicit method DOP853 and common, adaptive steps: the
// fastest way to many trajectories where symplecticity is not asked for.
//
// One step has 12 rates and two embedded results, of order 5 and 3, whose differences to that of
// order 8 make the error estimate; the lane with the largest one decides on the step.
//
// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.10, and their code: coefficients of the
// embedded methods, error norm and step control, but with the largest component instead of the mean
// square, and without its stiffness detection and dense output.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "carnot/dop853_tableau.h"
#include "carnot/packed_rate.h"

namespace carnot {

namespace dop853_steps {

inline constexpr int kStages = 12;

struct Coefficients {
  std::array<std::array<double, kStages>, kStages + 1> a{};  // the last row is b
  std::array<double, kStages> c{};
  std::array<double, kStages> third{};  // b minus the method of order 3
  std::array<double, kStages> fifth{};  // b minus the method of order 5
};

inline const Coefficients& coefficients() {
  static const Coefficients kCoefficients = [] {
    Coefficients k;
    const Tableau<double> tableau = dop853_tableau<double>();
    for (const Dop853Entry& entry : kDop853) {
      k.a[entry.i - 1][entry.j - 1] = decimal<double>(entry.value);
    }
    for (int i = 0; i < kStages; ++i) k.c[i] = tableau.c[i];
    k.third = k.a[kStages];
    k.third[0] -= decimal<double>("0.244094488188976377952755905512");
    k.third[8] -= decimal<double>("0.733846688281611857341361741547");
    k.third[11] -= decimal<double>("0.0220588235294117647058823529412");
    k.fifth[0] = decimal<double>("0.01312004499419488073250102996");
    k.fifth[5] = decimal<double>("-1.225156446376204440720569753");
    k.fifth[6] = decimal<double>("-0.4957589496572501915214079952");
    k.fifth[7] = decimal<double>("1.664377182454986536961530415");
    k.fifth[8] = decimal<double>("-0.3503288487499736816886487290");
    k.fifth[9] = decimal<double>("0.3341791187130174790297318841");
    k.fifth[10] = decimal<double>("0.08192320648511571246570742613");
    k.fifth[11] = decimal<double>("-0.02235530786388629525884427845");
    return k;
  }();
  return kCoefficients;
}

// row k of `to` <- row k of z + h sum_j weight_j (row k of f_j).
template <int size, int W, int stages>
[[gnu::flatten, gnu::noinline]] void combine(
    const double* z, double h, const double* weights, const double* f, double* to) {
  using P = Pack<W>;
  for (int k = 0; k < size; ++k) {
    P sum(0);
    for (int j = 0; j < stages; ++j) {
      if (weights[j] != 0) sum += P(weights[j]) * P::load(f + (j * size + k) * W);
    }
    (P::load(z + k * W) + P(h) * sum).store(to + k * W);
  }
}

// The error of the step over the tolerance, largest of all lanes and components: with e5, e3 the
// differences to the embedded results, h e5^2 / sqrt(e5^2 + e3^2 / 100).
template <int size, int W>
[[gnu::flatten, gnu::noinline]] double error_ratio(
    const double* z, const double* end, double h, double tolerance, const double* f) {
  using P = Pack<W>;
  const Coefficients& k = coefficients();
  P fifth_square(0);
  P third_square(0);
  for (int i = 0; i < size; ++i) {
    P fifth(0);
    P third(0);
    for (int j = 0; j < kStages; ++j) {
      if (k.fifth[j] == 0 && k.third[j] == 0) continue;
      const P rate = P::load(f + (j * size + i) * W);
      fifth += P(k.fifth[j]) * rate;
      third += P(k.third[j]) * rate;
    }
    const P scale = P(tolerance) * (P(1) + max(abs(P::load(z + i * W)), abs(P::load(end + i * W))));
    const P fifth_ratio = fifth / scale;
    const P third_ratio = third / scale;
    fifth_square += fifth_ratio * fifth_ratio;
    third_square += third_ratio * third_ratio;
  }
  const P scale = sqrt(max(P(size) * (fifth_square + P(0.01) * third_square), P(1e-300)));
  return largest(P(std::abs(h)) * fifth_square / scale);
}

}  // namespace dop853_steps

struct AdaptiveReport {
  bool completed = false;
  long steps = 0;
  long rejected = 0;
  long evaluations = 0;  // per lane
};

// Advances W phase points, in rows of W numbers, by `duration`, with local errors of about
// `tolerance`, absolute below size 1 and relative above. On failure z is where the last good step
// left it.
template <int W, class System>
AdaptiveReport dop853_adaptive(
    const System& system, double start, double duration, double tolerance, double* z) {
  using namespace dop853_steps;
  constexpr int size = 2 * System::kDof;
  constexpr double kSafety = 0.8;
  constexpr double kMostShrink = 0.333;
  constexpr double kMostGrowth = 2;
  constexpr long kMostSteps = 1L << 24;
  alignas(64) std::array<double, kStages * size * W> f;
  alignas(64) std::array<double, size * W> stage;
  alignas(64) std::array<double, System::kAlgebraic * W> y;
  alignas(64) std::array<double, W> time;
  const Coefficients& k = coefficients();
  AdaptiveReport report;
  const auto rate = [&](double t, const double* at, int i) {
    time.fill(t);
    ++report.evaluations;
    return packed_rate<W>(system, time.data(), at, y.data(), f.data() + i * size * W);
  };
  if (!rate(start, z, 0)) return report;

  // A first step that moves by a hundredth of the size of z, as far as the tolerance allows.
  double speed = 0;
  double extent = 0;
  for (int i = 0; i < size * W; ++i) {
    speed = std::max(speed, std::abs(f[i]));
    extent = std::max(extent, std::abs(z[i]));
  }
  double h = std::abs(duration);
  if (speed > 0) {
    h = std::min(h, std::pow(tolerance, 0.125) * std::max(extent, 1.0) / speed);
  }
  const double sign = duration < 0 ? -1 : 1;
  double left = std::abs(duration);
  bool after_rejection = false;
  while (left > 0 && report.steps + report.rejected < kMostSteps) {
    const bool last = h * 1.01 >= left;
    const double step = sign * (last ? left : h);
    const double t = start + duration - sign * left;
    bool ok = true;
    const auto stages = [&]<int... i>(std::integer_sequence<int, i...>) {
      ((combine<size, W, i + 1>(z, step, k.a[i + 1].data(), f.data(), stage.data()),
        ok = ok && rate(t + k.c[i + 1] * step, stage.data(), i + 1)),
       ...);
    };
    stages(std::make_integer_sequence<int, kStages - 1>{});
    double ratio = INFINITY;
    if (ok) {
      combine<size, W, kStages>(z, step, k.a[kStages].data(), f.data(), stage.data());
      ratio = error_ratio<size, W>(z, stage.data(), step, tolerance, f.data());
    }
    const double growth =
        std::isfinite(ratio) ? kSafety / std::pow(std::max(ratio, 1e-10), 0.125) : kMostShrink;
    if (ratio <= 1) {
      ++report.steps;
      std::copy(stage.begin(), stage.end(), z);
      left = last ? 0 : left - std::abs(step);
      h = std::abs(step) * std::clamp(growth, kMostShrink, after_rejection ? 1.0 : kMostGrowth);
      after_rejection = false;
      if (left > 0 && !rate(start + duration - sign * left, z, 0)) return report;
    } else {
      ++report.rejected;
      h = std::abs(step) * std::clamp(growth, kMostShrink, 1.0);
      after_rejection = true;
      if (h < 1e-14 * std::abs(duration)) return report;
    }
  }
  report.completed = left == 0;
  return report;
}

}  // namespace carnot
