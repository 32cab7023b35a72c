// What counts as round-off, where several files must mean the same by it.
#pragma once

#include <limits>

namespace carnot {

// Of a matrix with n rows, relative to the diagonal: a pivot that is not larger may be what the
// rounding of its own row left of zero. `T` is a real type.
template <class T>
constexpr T pivot_round_off(int n) {
  return 16 * n * std::numeric_limits<T>::epsilon();
}

// What an iteration may leave where it falls no more, in units of the rounding error of its
// equations: with more it has found nothing.
inline constexpr int kStalledRoundOff = 100;

}  // namespace carnot
