// The momenta of unit speed at a point, H(p) = 1/2.
//
// H is p'A p / 2 at the point, with A of rank r. With A = V diag(a) V' on its range and N a basis
// of its kernel, the momenta of unit speed are
//
//   p = V diag(a)^(-1/2) c + N y,     |c| = 1,
//
// a sphere of r - 1 dimensions times a space. Conditions p_j = b leave a plane or a line of y, or
// nothing of it: y = y0(c) + K w. So there are
//
//   surfaces: a circle times a line (r = 2), a sphere (r = 3),
//   curves:   two lines (r = 1), a circle (r = 2),
//
// and a circle times a plane, of which a condition on the ends leaves a surface
// (front/end_section.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "carnot/dynamics.h"

namespace carnot::internal {

// What tells one of these momenta. Of c, r numbers count; of w one where there is a line, and two
// where there is a plane. The others are 0.
struct UnitMomentum {
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  Eigen::Vector2d w = Eigen::Vector2d::Zero();
};

// From one to another: c along the great circle, w straight on.
UnitMomentum between(const UnitMomentum& a, const UnitMomentum& b, double part);

class UnitMomenta {
 public:
  // Throws std::invalid_argument where H(p) = 1/2 with the conditions is no surface or, with two
  // coordinates, no curve; and where a condition on the ends is still to come, no circle times a
  // plane.
  UnitMomenta(const Dynamics& dynamics,
              const std::vector<double>& from,
              const std::vector<std::pair<int, double>>& conditions,
              bool condition_on_ends = false);

  [[nodiscard]] std::vector<double> momentum(const UnitMomentum& place) const;
  // The place of a momentum of unit speed.
  [[nodiscard]] UnitMomentum place(const std::vector<double>& p) const;

  [[nodiscard]] int rank() const { return static_cast<int>(circle_.cols()); }
  // Of a plane: takes its axes instead of the orthonormal ones, columns in terms of those.
  void set_plane(const Eigen::Matrix2d& axes);
  // How many numbers of w count.
  [[nodiscard]] int lines() const { return static_cast<int>(lines_.cols()); }
  [[nodiscard]] bool has_line() const { return lines() > 0; }
  // 1: curves, 2: surfaces, 3: a circle times a plane.
  [[nodiscard]] int dimension() const { return rank() - 1 + lines(); }
  // Of a surface: two independent ways to move. The third one of a plane is along its second axis.
  // And dp along a way at a momentum.
  [[nodiscard]] std::array<UnitMomentum, 2> ways(const UnitMomentum& at) const;
  [[nodiscard]] Eigen::VectorXd tangent(const UnitMomentum& at, const UnitMomentum& way) const;
  // `count` directions c, spread evenly.
  [[nodiscard]] std::vector<Eigen::Vector3d> directions(int count) const;

 private:
  [[nodiscard]] Eigen::VectorXd around(const Eigen::Vector3d& c) const;

  Eigen::MatrixXd circle_;     // n x r
  Eigen::MatrixXd on_circle_;  // r x n, its left inverse
  Eigen::MatrixXd slope_;      // n x r and n, of the conditions:
  Eigen::VectorXd base_;       // p = circle c + base + slope c + lines w
  Eigen::MatrixXd lines_;      // columns, of which there may be none: orthonormal unless set
  Eigen::MatrixXd on_lines_;   // their left inverse
};

}  // namespace carnot::internal
