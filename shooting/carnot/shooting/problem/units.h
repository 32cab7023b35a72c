// Units in which a short extremal is not short.
//
// Along an extremal of length d, a direction of weight w (dilation.h) moves by d^w and has momenta
// of d^(2 - w). So the blocks of the tangent flow are graded, and no threshold tells a small
// singular value from round-off. The symplectic change q = from + E q~, p = c E^-T p~ makes all of
// them of size one. Here E is the basis adapted to the flag times the d^w, and c = d^2 / T.
//
// Where ends are free, momenta stand among configurations and the other way round (ends.h). There a
// momentum r counts as one, with 1/r the length that one unit of momentum stands for.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

class Units {
 public:
  // For the extremal of `problem` with the unknowns x at its start. Where it is not short, or where
  // there is no dilation, the units are those of the coordinates.
  Units(const BoundaryValueProblem& problem, const std::vector<double>& x);

  [[nodiscard]] bool scaled() const { return scaled_; }
  // The tangent flow m, 2n x 2n, and the columns of end_point_tangent().
  [[nodiscard]] Eigen::MatrixXd map(Eigen::MatrixXd m) const;
  [[nodiscard]] Eigen::MatrixXd tangent(const Eigen::MatrixXd& columns) const;
  // The norm of unknowns of the start: momenta where no end is free.
  [[nodiscard]] double size(const Eigen::VectorXd& p) const;
  // From a displacement at the target, and back to unknowns of the start.
  [[nodiscard]] Eigen::VectorXd displacement(const Eigen::VectorXd& q) const;
  [[nodiscard]] Eigen::MatrixXd momenta(const Eigen::MatrixXd& p) const;

 private:
  bool scaled_ = false;
  Eigen::MatrixXd e_;
  Eigen::MatrixXd inverse_;
  double c_ = 1;
  Eigen::VectorXd start_;   // where ends are free: the unit of each unknown,
  Eigen::VectorXd target_;  // and what one of each condition counts
};

}  // namespace carnot::internal
