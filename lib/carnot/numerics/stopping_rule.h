// When to end a fixed-point iteration that is to go on to round-off.
//
// It goes on while for some component the largest change is still falling (Antonana, Makazaga &
// Murua 2017), so it ends at round-off whatever the scale of the components, with one iteration of
// grace when it stalls.
#pragma once

#include <algorithm>
#include <limits>

#include "carnot/numerics/linear_algebra.h"

namespace carnot {

template <class T, int size>
class StoppingRule {
 public:
  enum class Verdict { kGoOn, kAtRest, kStalled };

  // After an iteration that changed each component by up to `change`, of which `most` is the
  // largest.
  Verdict operator()(const Vector<T, size>& change, const T& most) {
    bool falling = first_;
    bool at_rest = true;
    for (int k = 0; k < size; ++k) {
      falling = falling || (change[k] > T(0) && change[k] < smallest_[k]);
      at_rest = at_rest && change[k] == T(0);
      smallest_[k] = std::min(smallest_[k], change[k]);
    }
    first_ = false;
    if (at_rest) return Verdict::kAtRest;
    if (!falling) {
      // Where q' depends on p alone and p' on q alone, the errors of q and p take turns, and one
      // of them may be zero by luck: the other one still contracts.
      const bool contracts = most < before_last_ / T(4);
      if (!grace_ && !contracts) return Verdict::kStalled;
      if (!grace_) smallest_.setConstant(kFar);
      grace_ = false;
    }
    before_last_ = last_;
    last_ = most;
    return Verdict::kGoOn;
  }

 private:
  static constexpr T kFar = std::numeric_limits<T>::max();
  Vector<T, size> smallest_ = Vector<T, size>::Constant(kFar);
  T last_ = kFar;
  T before_last_ = kFar;
  bool first_ = true;
  bool grace_ = true;
};

}  // namespace carnot
