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
  // Which coordinates of an end are free; empty: none. The number in `from` or `to` is where the
  // search begins to look for such a coordinate.
  std::vector<bool> free_from;
  std::vector<bool> free_to;
  // What the path has to keep to; at first that of the scene.
  std::vector<Limit> limits;

  // make_dynamics.h makes a Dynamics of a scene.
  BoundaryValueProblem(Dynamics system,
                       std::vector<double> start,
                       std::vector<double> target,
                       double duration = 1)
      : dynamics(std::move(system)),
        from(std::move(start)),
        to(std::move(target)),
        time(duration),
        limits(dynamics.info.limits) {}

  // Whether coordinate j, from 0, is free at the start.
  [[nodiscard]] bool is_free_from(int j) const { return !free_from.empty() && free_from[j]; }
  // Whether coordinate j, from 0, is free at the target.
  [[nodiscard]] bool is_free_to(int j) const { return !free_to.empty() && free_to[j]; }
  // Whether any coordinate is free, at the start or at the target.
  [[nodiscard]] bool has_free_ends() const;
  // Whether any coordinate is free at the target.
  [[nodiscard]] bool has_free_target() const;

  // Throws std::invalid_argument: wrong lengths, values that are not finite, T <= 0, constraints
  // that are dependent at an end, free ends on a manifold h(q) = 0.
  void validate() const;
};

}  // namespace carnot
