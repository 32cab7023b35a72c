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

#include "carnot/system/packed_rate.h"
#include "carnot/tableau/dop853_embedded.h"

namespace carnot {

namespace dop853 {

// Row k of sum_j w_j f_j, over the weights that do not vanish.
template <int size, int W>
[[gnu::always_inline]] inline Pack<W> weighted_row(const Weights& w, const double* f, int k) {
  Pack<W> sum(0);
  for (int j = 0; j < kStages; ++j) {
    if (w[j] != 0) sum += Pack<W>(w[j]) * Pack<W>::load(f + (j * size + k) * W);
  }
  return sum;
}

// Row k of `to` <- row k of z + h sum_j w_j f_j.
template <int size, int W>
[[gnu::flatten, gnu::noinline]] void combine(
    const Weights& w, const double* z, double h, const double* f, double* to) {
  for (int k = 0; k < size; ++k) {
    const Pack<W> sum = weighted_row<size, W>(w, f, k);
    (Pack<W>::load(z + k * W) + Pack<W>(h) * sum).store(to + k * W);
  }
}

// The error of the step over the tolerance, largest of all lanes and components: with e5, e3 the
// differences to the embedded results, h e5^2 / sqrt(e5^2 + e3^2 / 100).
template <int size, int W>
[[gnu::flatten, gnu::noinline]] double error_ratio(
    const double* z, const double* end, double h, double tolerance, const double* f) {
  using P = Pack<W>;
  P fifth_square(0);
  P third_square(0);
  for (int i = 0; i < size; ++i) {
    const P scale = P(tolerance) * (P(1) + max(abs(P::load(z + i * W)), abs(P::load(end + i * W))));
    const P fifth_ratio = weighted_row<size, W>(kError5, f, i) / scale;
    const P third_ratio = weighted_row<size, W>(kError3, f, i) / scale;
    fifth_square += fifth_ratio * fifth_ratio;
    third_square += third_ratio * third_ratio;
  }
  const P scale = sqrt(max(P(size) * (fifth_square + P(0.01) * third_square), P(1e-300)));
  return largest(P(std::abs(h)) * fifth_square / scale);
}

}  // namespace dop853

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
  using namespace dop853;
  constexpr int size = 2 * System::kDof;
  constexpr double kSafety = 0.8;
  constexpr double kMostShrink = 0.333;
  constexpr double kMostGrowth = 2;
  constexpr long kMostSteps = 1L << 24;
  alignas(64) std::array<double, kStages * size * W> f;
  alignas(64) std::array<double, size * W> stage;
  alignas(64) std::array<double, System::kAlgebraic * W> y;
  alignas(64) std::array<double, W> time;
  static const Tableau<double> kTableau = dop853_tableau<double>();
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
    for (int i = 1; i < kStages && ok; ++i) {
      combine<size, W>(kA[i], z, step, f.data(), stage.data());
      ok = rate(t + kTableau.c[i] * step, stage.data(), i);
    }
    double ratio = INFINITY;
    if (ok) {
      combine<size, W>(kA[kStages], z, step, f.data(), stage.data());
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
