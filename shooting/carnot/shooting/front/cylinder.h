// The momenta of unit speed at a point, H(p) = 1/2: a cylinder, told by two numbers.
//
// H is p'A p / 2 at the point, with A of rank r. With A = V diag(a) V' on its range and N a basis
// of its kernel, the momenta of unit speed are
//
//   p = V diag(a)^(-1/2) (cos phi, sin phi) + N y,
//
// a circle times a space for r = 2. Where y has more than one dimension, conditions p_j = c leave a
// line of it: y = y0(phi) + K w.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

class Cylinder {
 public:
  // Throws std::invalid_argument where H(p) = 1/2 with the conditions is no circle times a line.
  Cylinder(const Dynamics& dynamics,
           const std::vector<double>& from,
           const std::vector<std::pair<int, double>>& conditions);

  [[nodiscard]] std::vector<double> momentum(double phi, double w) const;
  // (phi, w) of a momentum on it, phi in (-pi, pi].
  [[nodiscard]] std::pair<double, double> coordinates(const std::vector<double>& p) const;

 private:
  [[nodiscard]] Eigen::VectorXd around(double phi) const;

  Eigen::MatrixXd circle_;     // n x 2
  Eigen::MatrixXd on_circle_;  // 2 x n, its left inverse
  Eigen::MatrixXd slope_;      // n x 2 and n, of the conditions:
  Eigen::VectorXd base_;       // p = circle c + base + slope c + line w
  Eigen::VectorXd line_;       // of length 1
};

}  // namespace carnot::internal
