// What is asked: an extremal of a scene that joins two configurations in a given time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot {

// kOk, or why no geodesic can end at q (length n): dependent constraints, singular coordinates.
RateStatus end_status(const Dynamics& dynamics, const std::vector<double>& q);

struct BoundaryValueProblem {
  Dynamics dynamics;         // scene and method
  std::vector<double> from;  // q(0), length n
  std::vector<double> to;    // q(T), length n
  double time = 1;           // T > 0

  // make_dynamics.h makes a Dynamics of a scene.
  BoundaryValueProblem(Dynamics system,
                       std::vector<double> start,
                       std::vector<double> target,
                       double duration = 1)
      : dynamics(std::move(system)),
        from(std::move(start)),
        to(std::move(target)),
        time(duration) {}

  // Throws std::invalid_argument: wrong lengths, values that are not finite, T <= 0, constraints
  // that are dependent at an end.
  void validate() const;
};

}  // namespace carnot
