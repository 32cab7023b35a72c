// Numbers that are spread evenly, without a generator: the same in every run.
#pragma once

#include <cmath>

namespace carnot {

// Number k of a sequence in [-1, 1): the multiples of the golden section modulo 1, stretched. Any
// run of them leaves no large gap.
inline double evenly_spread(int k) {
  constexpr double kGolden = 0.6180339887498949;
  const double turn = kGolden * static_cast<double>(k);
  return 2 * (turn - std::floor(turn)) - 1;
}

}  // namespace carnot
