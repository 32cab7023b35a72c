// Dilations: how a scene looks from nearby.
//
// Let X_1, ..., X_m span the admissible directions D at a configuration q0, and D = D_1 < D_2 < ...
// be the flag: D_w holds the brackets of up to w of them. With weights w_j, the number of brackets
// that coordinate j of a basis adapted to the flag takes, extremals of size d look the same for
// d -> 0 but for the dilation y_j -> d^(w_j) y_j (Bellaiche, "The tangent space in sub-Riemannian
// geometry", 1996, sections 4 and 5): distances are of the order of the gauge max |y_j|^(1/w_j).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "carnot/shooting/boundary_value_problem.h"

namespace carnot::internal {

class Dilation {
 public:
  // Of the scene around problem.from. Brackets are differences of differences, good to about 1e-3.
  // Nothing where brackets of up to four fields leave a direction out, or where the frame is
  // singular. Cost: some hundred evaluations of the constraints.
  static std::optional<Dilation> at_start(const BoundaryValueProblem& problem);

  [[nodiscard]] int dof() const { return static_cast<int>(weights_.size()); }
  [[nodiscard]] double unit() const { return unit_; }  // S, the length of a radian (starts.h)
  [[nodiscard]] const std::vector<int>& weights() const { return weights_; }
  // Columns, orthonormal in the metric at `from` (of what the constraints forbid too).
  [[nodiscard]] const Eigen::MatrixXd& basis() const { return basis_; }
  // Coordinates y, lengths, of the displacement from `from`; and back.
  [[nodiscard]] Eigen::VectorXd coordinates(const double* q) const;
  void place(const Eigen::VectorXd& y, double* q) const;
  // y with each coordinate multiplied by factor^weight.
  [[nodiscard]] Eigen::VectorXd scaled(Eigen::VectorXd y, double factor) const;
  // max (|y_j| / S)^(1/w_j).
  [[nodiscard]] double gauge(const Eigen::VectorXd& y) const;

 private:
  std::vector<double> from_;
  Eigen::MatrixXd basis_;
  Eigen::MatrixXd inverse_;
  std::vector<int> weights_;
  double unit_ = 1;
};

// What the admissible velocities at problem.from span together with their brackets of up to four.
struct BracketSpan {
  int dimension = 0;  // n where they cannot be evaluated
  // The covector of length 1 that annihilates them, where they leave one direction out: the
  // derivatives of a quantity that the constraints keep, unless longer brackets tell otherwise.
  std::optional<Eigen::VectorXd> annihilator;
};
// Cost: some hundred evaluations of the constraints.
BracketSpan bracket_span(const BoundaryValueProblem& problem);

}  // namespace carnot::internal
