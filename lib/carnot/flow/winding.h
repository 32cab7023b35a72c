// Angles kept small on long runs: whole turns are taken off the state and counted.
//
// A stage is rounded to an ulp of its angle, so that without this the error of H would grow with
// the turns that an angle has made; here it grows with the number of steps alone. Periods are
// multiples of pi and known to more digits than double has. Turns are taken off beyond three
// quarters of a period, so that an angle does not go back and forth.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "carnot/system/phase_space.h"

namespace carnot {

template <int n>
class Winding {
 public:
  Winding() { limit_.fill(std::numeric_limits<double>::infinity()); }
  // 0 for a coordinate without a period.
  explicit Winding(const std::array<double, n>& periods) : Winding() {
    constexpr long double kPi = std::numbers::pi_v<long double>;
    for (int i = 0; i < n; ++i) {
      if (!(periods[i] > 0)) continue;
      period_[i] = periods[i];
      limit_[i] = 0.75 * periods[i];
      const long double exact = std::round(periods[i] / std::numbers::pi) * kPi;
      if (static_cast<double>(exact) == periods[i]) {
        rest_[i] = static_cast<double>(exact - static_cast<long double>(periods[i]));
      }
    }
  }

  // Takes whole turns off.
  void fold(State<double, n>& z) {
    for (int i = 0; i < n; ++i) {
      if (std::abs(z.value[i]) > limit_[i]) turn(i, -std::round(z.value[i] / period_[i]), z);
    }
  }

  // z with all turns that were taken off.
  [[nodiscard]] State<double, n> unfolded(State<double, n> z) const {
    Winding back = *this;
    for (int i = 0; i < n; ++i) {
      if (turns_[i] != 0) back.turn(i, turns_[i], z);
    }
    return z;
  }

 private:
  // Adds turns to an angle, without losing a digit of the sum.
  void turn(int i, double turns, State<double, n>& z) {
    const double whole = turns * period_[i];
    const double rest = std::fma(turns, period_[i], -whole) + turns * rest_[i];
    const double sum = z.value[i] + whole;
    const double part = sum - z.value[i];
    z.compensation[i] += ((z.value[i] - (sum - part)) + (whole - part)) + rest;
    z.value[i] = sum;
    turns_[i] -= turns;
  }

  std::array<double, n> period_{};
  std::array<double, n> rest_{};  // of the period, beyond double
  std::array<double, n> limit_;
  std::array<double, n> turns_{};  // taken off
};

}  // namespace carnot
