// A wall at a point of an extremal, and the scene that is held on it.
#pragma once

#include <Eigen/Core>
#include <map>

#include "carnot/shooting/boundary_value_problem.h"
#include "carnot/shooting/problem/hamiltonian_terms.h"
#include "carnot/shooting/problem/walls.h"
#include "carnot/shooting/shoot/bound_arcs.h"

namespace carnot::internal {

struct WallAt {
  double s = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};
WallAt wall_at(const Walls& walls, int n, int wall, const double* q);

// ds.H_p of the scene without bounds at z = (q, p), and its derivatives by q and p. NaN where H
// cannot be evaluated.
struct Approach {
  double rate = 0;
  Eigen::VectorXd by_q;
  Eigen::VectorXd by_p;
};
Approach approach(HamiltonianTerms& terms, const WallAt& wall, const double* z);

// The scene on each wall that pieces keep to.
class Held {
 public:
  Held(const BoundaryValueProblem& problem, const Walls& walls, const BoundExtremal& extremal);

  // False where the scene cannot be held on one of them.
  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] const Dynamics& of(const Piece& piece) const {
    return piece.wall < 0 ? problem_.dynamics : scenes_.at(piece.wall);
  }

 private:
  const BoundaryValueProblem& problem_;
  std::map<int, Dynamics> scenes_;
  bool exists_ = true;
};

}  // namespace carnot::internal
