#include "carnot/flow/dop853_adaptive.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "carnot/numerics/pack.h"
#include "carnot/tableau/dop853_embedded.h"

namespace carnot {
namespace {

using namespace dop853;

using P = Pack<kErasedLanes>;

// Row k of sum_j w_j f_j; each f_j has `size` rows.
template <const Weights& w>
[[gnu::always_inline]] inline P weighted_row(const double* f, int size, int k) {
  return weighted<w>(P(0), [&](int j) { return P::load(f + (j * size + k) * kErasedLanes); });
}

// Row k of `to` <- row k of z + h sum_j a_ij f_j. The weights are known to the compiler: where they
// were looked up the sums took as long as the rates of the vehicle.
template <int i>
[[gnu::flatten, gnu::noinline]] void combine(
    const double* z, double h, const double* f, int size, double* to) {
  for (int k = 0; k < size; ++k) {
    const P sum = weighted_row<kRow<i>>(f, size, k);
    (P::load(z + k * kErasedLanes) + P(h) * sum).store(to + k * kErasedLanes);
  }
}
constexpr auto kCombine = []<int... i>(std::integer_sequence<int, i...> /*stages*/) {
  return std::array{&combine<i>...};
}
(std::make_integer_sequence<int, kStages + 1>{});

using LaneNumbers = std::array<double, kErasedLanes>;

double eighth_root(double x) { return std::sqrt(std::sqrt(std::sqrt(x))); }

// The error of the step over the tolerance, largest of all components: with e5, e3 the differences
// to the embedded results, h e5^2 / sqrt(e5^2 + e3^2 / 100).
[[gnu::flatten, gnu::noinline]] LaneNumbers error_ratio(
    const double* z, const double* end, double h, double tolerance, const double* f, int size) {
  P fifth_square(0);
  P third_square(0);
  for (int i = 0; i < size; ++i) {
    const P scale = P(tolerance) * (P(1) + max(abs(P::load(z + i * kErasedLanes)),
                                               abs(P::load(end + i * kErasedLanes))));
    // One division a row: they were more than half of the time here.
    const P per_scale = P(1) / scale;
    const P fifth_ratio = weighted_row<kError5>(f, size, i) * per_scale;
    const P third_ratio = weighted_row<kError3>(f, size, i) * per_scale;
    fifth_square += fifth_ratio * fifth_ratio;
    third_square += third_ratio * third_ratio;
  }
  const P scale = sqrt(max(P(size) * (fifth_square + P(0.01) * third_square), P(1e-300)));
  alignas(64) LaneNumbers ratios;
  (P(std::abs(h)) * fifth_square / scale).store(ratios.data());
  return ratios;
}

}  // namespace

int adaptive_rows(const SystemFunctions& functions) {
  return (kStages + 1) * 2 * functions.dof + functions.algebraic + 1;
}

AdaptiveReport dop853_adaptive(const AdaptiveFlow& flow, double* z, double* memory) {
  const auto& [functions, system, start, duration, tolerance, most_steps] = flow;
  constexpr double kSafety = 0.8;
  constexpr double kMostShrink = 0.333;
  constexpr double kMostGrowth = 2;
  static const Tableau<double> kTableau = dop853_tableau<double>();
  const int size = 2 * functions.dof;
  double* const f = memory;
  double* const stage = f + kStages * size * kErasedLanes;
  double* const y = stage + size * kErasedLanes;
  double* const time = y + functions.algebraic * kErasedLanes;
  AdaptiveReport report;
  const auto rate = [&](double t, const double* at, int i) {
    std::fill_n(time, kErasedLanes, t);
    ++report.evaluations;
    return flow.functions.rates(flow.system, time, at, y, f + i * size * kErasedLanes);
  };
  if (!rate(start, z, 0)) return report;

  // A first step that moves by a hundredth of the size of z, as far as the tolerance allows.
  double speed = 0;
  double extent = 0;
  for (int i = 0; i < size * kErasedLanes; ++i) {
    speed = std::max(speed, std::abs(f[i]));
    extent = std::max(extent, std::abs(z[i]));
  }
  double h = std::abs(duration);
  if (speed > 0) {
    h = std::min(h, eighth_root(tolerance) * std::max(extent, 1.0) / speed);
  }
  const double sign = duration < 0 ? -1 : 1;
  double left = std::abs(duration);
  bool after_rejection = false;
  while (left > 0 && report.steps + report.rejected < most_steps) {
    const bool last = h * 1.01 >= left;
    const double step = sign * (last ? left : h);
    const double t = start + duration - sign * left;
    bool ok = true;
    for (int i = 1; i < kStages && ok; ++i) {
      kCombine[i](z, step, f, size, stage);
      ok = rate(t + kTableau.c[i] * step, stage, i);
    }
    double ratio = INFINITY;
    if (ok) {
      kCombine[kStages](z, step, f, size, stage);
      const LaneNumbers ratios = error_ratio(z, stage, step, tolerance, f, size);
      const auto* const hardest = std::max_element(
          ratios.begin(), ratios.end(), [](double a, double b) { return a < b || std::isnan(b); });
      report.hardest = static_cast<int>(hardest - ratios.begin());
      ratio = *hardest;
    }
    const double growth =
        std::isfinite(ratio) ? kSafety / eighth_root(std::max(ratio, 1e-10)) : kMostShrink;
    if (ratio <= 1) {
      ++report.steps;
      std::copy_n(stage, size * kErasedLanes, z);
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
