// The momenta of unit speed at a point, H(p) = 1/2.
//
// H is p'A p / 2 at the point, with A of rank r. With A = V diag(a) V' on its range and N a basis
// of its kernel, the momenta of unit speed are
//
//   p = V diag(a)^(-1/2) c + N y,     |c| = 1,
//
// a sphere of r - 1 dimensions times a space. Conditions p_j = b leave a line of y, or nothing of
// it: y = y0(c) + K w. So there are
//
//   surfaces: a circle times a line (r = 2), a sphere (r = 3),
//   curves:   two lines (r = 1), a circle (r = 2).
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// What tells one of these momenta. Of c, r numbers count; w is 0 where there is no line.
struct UnitMomentum {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  double w = 0;
};

// From one to another: c along the great circle, w along the line.
UnitMomentum between(const UnitMomentum& a, const UnitMomentum& b, double part);

class UnitMomenta {
 public:
  // Throws std::invalid_argument where H(p) = 1/2 with the conditions is no surface or, with two
  // coordinates, no curve.
  UnitMomenta(const Dynamics& dynamics,
              const std::vector<double>& from,
              const std::vector<std::pair<int, double>>& conditions);

  [[nodiscard]] std::vector<double> momentum(const UnitMomentum& place) const;
  // The place of a momentum of unit speed.
  [[nodiscard]] UnitMomentum place(const std::vector<double>& p) const;

  [[nodiscard]] int rank() const { return static_cast<int>(circle_.cols()); }
  [[nodiscard]] bool has_line() const { return line_.size() > 0; }
  // 1: curves, 2: surfaces.
  [[nodiscard]] int dimension() const { return rank() - 1 + (has_line() ? 1 : 0); }
  // Of a surface: two independent ways to move, and dp along a way at a momentum.
  [[nodiscard]] std::array<UnitMomentum, 2> ways(const UnitMomentum& at) const;
  [[nodiscard]] Eigen::VectorXd tangent(const UnitMomentum& at, const UnitMomentum& way) const;
  // `count` directions c, spread evenly.
  [[nodiscard]] std::vector<Eigen::Vector3d> directions(int count) const;

 private:
  [[nodiscard]] Eigen::VectorXd around(const Eigen::Vector3d& c) const;

  Eigen::MatrixXd circle_;     // n x r
  Eigen::MatrixXd on_circle_;  // r x n, its left inverse
  Eigen::MatrixXd slope_;      // n x r and n, of the conditions:
  Eigen::VectorXd base_;       // p = circle c + base + slope c + line w
  Eigen::VectorXd line_;       // of length 1, or empty
};

}  // namespace carnot::internal
