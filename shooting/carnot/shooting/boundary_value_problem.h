// What is asked: an extremal of a scene that joins two configurations in a given time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "carnot/segment.h"

namespace carnot {

struct BoundaryValueProblem {
  Segment segment;           // scene and method
  std::vector<double> from;  // q(0), length n
  std::vector<double> to;    // q(T), length n
  double time = 1;           // T > 0

  BoundaryValueProblem(Segment dynamics,
                       std::vector<double> start,
                       std::vector<double> target,
                       double duration)
      : segment(std::move(dynamics)),
        from(std::move(start)),
        to(std::move(target)),
        time(duration) {}

  // A scene with gauss16.
  template <VelocityConstrainedScene Scene>
  BoundaryValueProblem(const Scene& scene,
                       std::vector<double> start,
                       std::vector<double> target,
                       double duration = 1)
      : BoundaryValueProblem(
            make_gauss_segment<8>(scene), std::move(start), std::move(target), duration) {}

  // Throws std::invalid_argument: wrong lengths, values that are not finite, T <= 0, constraints
  // that are dependent at an end.
  void validate() const;
};

}  // namespace carnot
