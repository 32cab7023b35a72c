// Units in which a short extremal is not short.
//
// Along an extremal of length d, a direction of weight w (dilation.h) moves by d^w and has momenta
// of d^(2 - w). So the blocks of the tangent flow are graded, and no threshold tells a small
// singular value from round-off. The symplectic change q = from + E q~, p = c E^-T p~ makes all of
// them of size one. Here E is the basis adapted to the flag times the d^w, and c = d^2 / T.
#pragma once

#include <Eigen/Core>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

class Units {
 public:
  // For the extremal of `problem` from p0. Where it is not short, or where there is no dilation,
  // the units are those of the coordinates.
  Units(const BoundaryValueProblem& problem, const double* p0);

  [[nodiscard]] bool scaled() const { return scaled_; }
  // The tangent flow m, 2n x 2n, and its last n columns (dq/dp0; dp/dp0).
  [[nodiscard]] Eigen::MatrixXd map(const Eigen::MatrixXd& m) const;
  [[nodiscard]] Eigen::MatrixXd tangent(const Eigen::MatrixXd& columns) const;
  // The norm of a momentum.
  [[nodiscard]] double size(const Eigen::VectorXd& p) const;
  // From a displacement, and back to momenta.
  [[nodiscard]] Eigen::VectorXd displacement(const Eigen::VectorXd& q) const;
  [[nodiscard]] Eigen::MatrixXd momenta(const Eigen::MatrixXd& p) const;

 private:
  bool scaled_ = false;
  Eigen::MatrixXd e_;
  Eigen::MatrixXd inverse_;
  double c_ = 1;
};

}  // namespace carnot::internal
