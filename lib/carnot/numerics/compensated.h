// Summation that carries its own rounding error (Kahan's compensated update).
#pragma once

namespace carnot {

// value + compensation is the sum, a scalar or an Eigen vector, but for one rounding of each
// increment, as long as increments are smaller than the value.
template <class T>
struct Compensated {
  T value;
  T compensation;

  void add(const T& increment) {
    const T corrected = compensation + increment;
    const T sum = value + corrected;
    const T represented = sum - value;
    compensation = corrected - represented;
    value = sum;
  }
};

}  // namespace carnot
