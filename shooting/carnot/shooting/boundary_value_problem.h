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

  BoundaryValueProblem(Segment segment_,
                       std::vector<double> from_,
                       std::vector<double> to_,
                       double time_)
      : segment(std::move(segment_)), from(std::move(from_)), to(std::move(to_)), time(time_) {}

  // A scene with gauss16.
  template <VelocityConstrainedScene Scene>
  BoundaryValueProblem(const Scene& scene,
                       std::vector<double> from_,
                       std::vector<double> to_,
                       double time_ = 1)
      : BoundaryValueProblem(
            make_gauss_segment<8>(scene), std::move(from_), std::move(to_), time_) {}

  // Throws std::invalid_argument: wrong lengths, values that are not finite, T <= 0, constraints
  // that are dependent at an end.
  void validate() const;
};

}  // namespace carnot
