// Discrete extremals to targets that are very near, by way of targets that are not.
//
// A target whose displacement takes brackets of order w and has size d^w is reached by a path of
// size d with momenta up to d^(1 - w) or so: the ratio of the scales leaves a penalty method no
// digits. Dilated (dilation.h) the target is easy, and its extremals look like those wanted;
// Newton's method (discrete_newton.h) follows each while the dilation is taken back. By what power
// of the dilation a coordinate of the path shrinks is read off the last step.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/dilation.h"
#include "carnot/shooting/path.h"

namespace carnot {

class NearTarget {
 public:
  // Nothing where the problem is easy as it is, or has no dilation.
  static std::optional<NearTarget> of(const BoundaryValueProblem& problem);

  // The dilation that a start uses: where relaxation does best, or half as much, or mostly none
  // where that is near. On the way back extremals meet others, and what is found from one may be
  // lost from the other.
  [[nodiscard]] double factor(int start) const {
    const int share = factor_ < 2 ? 4 : 2;
    return start / 2 % share == 0 ? factor_ : std::max(1.0, 0.5 * factor_);
  }
  // The easy problem.
  [[nodiscard]] BoundaryValueProblem dilated(double factor) const;
  // From a discrete extremal of the easy problem to one of the problem itself. False when it is
  // lost on the way.
  bool shrink(double factor, Path& path) const;

 private:
  NearTarget(const BoundaryValueProblem& problem, Dilation dilation, double factor)
      : problem_(problem), dilation_(std::move(dilation)), factor_(factor) {}

  const BoundaryValueProblem& problem_;
  Dilation dilation_;
  double factor_;
};

}  // namespace carnot
