// The fixed-point iteration on the stages of a step: when it goes on, and how it ends.
//
// It ends where no stage changes by more than the limit that a run asks for, or, without one, where
// the changes are round-off (stopping_rule.h). Where it contracts slowly it is given up for
// Newton's method.
#pragma once

#include <limits>

#include "carnot/numerics/stopping_rule.h"

namespace carnot {

template <class T>
struct IterationLimits {
  T stop{};             // the largest change at which the iteration ends; 0: at round-off
  int most = 0;         // iterations
  bool judged = false;  // it is given up where it contracts slowly
};

enum class IterationEnd { kSettled, kGaveUp, kRateFailed };

// Whether a change that does not fall any more is round-off of stages of this size. False for a NaN
// and for infinite stages.
template <class T>
bool is_round_off(const T& change, const T& scale) {
  constexpr int kUnits = 1000;
  return change < T(kUnits) * std::numeric_limits<T>::epsilon() * scale;
}

// `sweep(change)` does one iteration and returns the largest change of a stage, NaN where a rate
// fails; `change` is for that of each component, or null. `scale()` is the size of the stages.
template <class T, int size, class Sweep, class Scale>
[[gnu::always_inline]] inline IterationEnd iterate_stages(const IterationLimits<T>& limits,
                                                          const Sweep& sweep,
                                                          const Scale& scale) {
  constexpr T kRunsAway = 4;  // changes that grow by this are not going to settle
  constexpr int kJudged = 12;
  constexpr T kPoor = T(0.02);  // of the first change, after kJudged iterations: 0.7 an iteration
  using Rule = StoppingRule<T, size>;
  Rule rule;
  Vector<T, size> change;
  T first(0);
  for (int iteration = 0; iteration < limits.most; ++iteration) {
    const T most = sweep(limits.stop > T(0) ? nullptr : change.data());
    if (!(most >= T(0))) return IterationEnd::kRateFailed;
    if (iteration == 1) first = most;
    if (limits.stop > T(0)) {
      if (iteration > 1 && !(most <= kRunsAway * first)) return IterationEnd::kGaveUp;
      if (most <= limits.stop) return IterationEnd::kSettled;
    }
    if (limits.judged && iteration == kJudged && !(most <= kPoor * first)) {
      return IterationEnd::kGaveUp;
    }
    if (limits.stop > T(0)) continue;
    const auto verdict = rule(change, most);
    if (verdict == Rule::Verdict::kAtRest) return IterationEnd::kSettled;
    if (verdict == Rule::Verdict::kStalled) {
      const T size_of_stages = scale();
      for (int k = 0; k < size; ++k) {
        if (!is_round_off(change[k], size_of_stages)) return IterationEnd::kGaveUp;
      }
      return IterationEnd::kSettled;
    }
  }
  return IterationEnd::kGaveUp;
}

}  // namespace carnot
