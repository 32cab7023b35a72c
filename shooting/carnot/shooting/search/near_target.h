// Discrete extremals to targets that are very near, by way of targets that are not.
//
// A target whose displacement takes brackets of order w and has size d^w is reached by a path of
// size d, with momenta up to about d^(1 - w). This ratio of the scales leaves a penalty method no
// digits. Dilated (dilation.h), the target is easy, and its extremals look like those that are
// wanted. Newton's method (discrete_newton.h) follows each of them while the dilation is taken
// back. The last step tells by what power of the dilation each coordinate of the path shrinks.
#pragma once

#include <optional>
#include <utility>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/dilation.h"

namespace carnot::internal {

class NearTarget {
 public:
  // Nothing where the problem is easy as it is, or where the scene has no dilation at the start.
  static std::optional<NearTarget> of(const BoundaryValueProblem& problem);

  // A way to the target from one where the path is about `factor` times larger. That one is reached
  // by a dilation or, straight, by stretching the displacement as it is.
  struct Way {
    double factor = 1;
    bool straight = false;
  };
  // The way that a start uses: by dilation from where relaxation does best, straight, or by half of
  // that dilation. On the way back extremals meet others, so one way may find what another loses.
  [[nodiscard]] Way way(int start) const;
  // The easy problem.
  [[nodiscard]] BoundaryValueProblem easy(const Way& way) const;
  // From a discrete extremal of the easy problem to one of the problem itself. False when it is
  // lost on the way.
  bool shrink(Way way, Path& path) const;

 private:
  NearTarget(const BoundaryValueProblem& problem,
             Dilation dilation,
             double dilated,
             double stretched)
      : problem_(problem),
        dilation_(std::move(dilation)),
        dilated_(dilated),
        stretched_(stretched) {}

  const BoundaryValueProblem& problem_;
  Dilation dilation_;
  double dilated_;  // factors of the ways
  double stretched_;
};

}  // namespace carnot::internal
