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
    if constexpr (requires { increment.data(); }) {
      // Of copies the compiler knows that they are apart.
      T sums = value;
      T rests = compensation;
      for (int i = 0; i < increment.size(); ++i) {
        add(increment.data()[i], sums.data()[i], rests.data()[i]);
      }
      value = sums;
      compensation = rests;
    } else {
      add(increment, value, compensation);
    }
  }

 private:
  template <class Scalar>
  static void add(const Scalar& increment, Scalar& value, Scalar& compensation) {
    const Scalar corrected = compensation + increment;
    const Scalar sum = value + corrected;
    const Scalar represented = sum - value;
    compensation = corrected - represented;
    value = sum;
  }
};

}  // namespace carnot
