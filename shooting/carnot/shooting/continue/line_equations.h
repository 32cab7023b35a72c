// The equations of multiple shooting along a line of problems, F(u, s) = 0, with derivatives.
//
// The unknowns are x = (u, s). u holds the unknowns of the start (ends.h), which are p(0) where
// none of it is free, and the phase points at the inner knots, each divided by its scale. |u|^2 is
// a mean over the knots, so that arclength does not depend on how many there are. F_u is made of
// tangent flows, which are exact for the discrete map. F_s is exact where only the target moves.
// Elsewhere it is the derivative of the polynomial through five values of F near s.
#pragma once

#include <Eigen/Core>

#include "carnot/shooting/problem/problem_line.h"
#include "carnot/shooting/shoot/shooting_equations.h"

namespace carnot::internal {

class LineEquations {
 public:
  // Scales are those of `knots` at s. `steps` of the method over the whole time. Keeps a reference
  // to `line`.
  LineEquations(const ProblemLine& line, const Knots& knots, double s, long steps);

  [[nodiscard]] int size() const { return size_; }  // of u, and of F
  [[nodiscard]] int segments() const { return reference_.segments; }
  [[nodiscard]] long steps() const { return steps_; }
  [[nodiscard]] Eigen::VectorXd unknowns(const Knots& knots, double s) const;
  // The knots of x, the last row completed by a flow where that succeeds.
  [[nodiscard]] Knots knots(const Eigen::VectorXd& x) const;

  // The unknowns of the start and s of x, or of a rate of x; and an x that has them and is zero
  // elsewhere.
  [[nodiscard]] Eigen::VectorXd head(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd from_head(const Eigen::VectorXd& head) const;
  // Whether the momenta of x are still of the size of their scale.
  [[nodiscard]] bool in_scale(const Eigen::VectorXd& x) const;

  // F at x and its Jacobian, size() x (size() + 1). False when a flow fails or s is outside
  // [0, 1] by more than round-off.
  [[nodiscard]] bool evaluate(const Eigen::VectorXd& x,
                              Eigen::VectorXd& residual,
                              Eigen::MatrixXd& jacobian);

  // Largest entry of the scaled tangent flows at the last Jacobian.
  [[nodiscard]] double growth() const { return growth_; }

 private:
  // Whether F, not divided by the scales of its rows, could be formed.
  [[nodiscard]] bool values(const Eigen::VectorXd& x, double s, Eigen::VectorXd& f) const;
  [[nodiscard]] bool add_derivative_in_s(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const;
  [[nodiscard]] Knots open_knots(const Eigen::VectorXd& x, const std::vector<double>& from) const;

  const ProblemLine& line_;
  Knots reference_;
  long steps_;
  int size_;
  std::vector<int> places_;  // of the unknowns among the knots
  Eigen::VectorXd weights_;  // what one unit of u is
  Eigen::VectorXd rows_;     // and one unit of F
  std::vector<double> scale_;
  double growth_ = 0;
};

}  // namespace carnot::internal
