// A problem with limits beside the same without, and the sizes of both.
#pragma once

#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/geodesic.h"
#include "carnot/shooting/path/interior_point.h"
#include "carnot/shooting/path/path.h"
#include "carnot/shooting/problem/mass_ladder.h"
#include "carnot/shooting/problem/walls.h"
#include "carnot/shooting/shoot/knots.h"

namespace carnot::internal {

class LimitedProblem {
 public:
  static constexpr double kBeyond = 1e-9;  // of the size of a wall, counts as beyond it

  // `free` are geodesics without limits, least action first. Keeps a reference to the problem.
  LimitedProblem(const BoundaryValueProblem& limited, const std::vector<Geodesic>& free);

  // Whether the limits that are reported of a geodesic are kept to.
  [[nodiscard]] bool keeps_to_limits(const Geodesic& geodesic, double beyond = kBeyond) const;
  // A geodesic without limits that keeps to them anyway, with what they say of it.
  [[nodiscard]] std::optional<Geodesic> within(const Geodesic& geodesic) const;
  // The nodes and multipliers along a geodesic without limits. Nothing where its flow from p0 does
  // not arrive.
  [[nodiscard]] std::optional<Path> path_along(const Geodesic& geodesic, int intervals) const;
  // The nodes and multipliers of a path through knots. Its end is that of the problem.
  [[nodiscard]] Path path_through(const Knots& knots) const;
  // Sets what the points of a path say of each limit.
  void report_limits(const std::vector<std::vector<double>>& q, Geodesic& geodesic) const;

  const BoundaryValueProblem& problem;
  BoundaryValueProblem unlimited;
  MassLadder ladder;  // of the problem with its limits
  Walls walls;
  InteriorPointOptions interior;  // with the sizes of the walls and the rate of action

 private:
  void set_sizes(const std::vector<Geodesic>& free);
};

}  // namespace carnot::internal
