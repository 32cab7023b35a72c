#include "carnot/shooting/front/unit_momenta.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/rays/ray.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRank = 1e-10;  // eigenvalues of A below this, relative, are zero

// A, whose columns are the velocities of the unit momenta.
MatrixXd metric_at(const Dynamics& dynamics, const std::vector<double>& from) {
  const int n = dynamics.dof;
  MatrixXd a(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<double> z = from;
    z.resize(2 * n, 0.0);
    z[n + j] = 1;
    a.col(j) = motion_at(dynamics, z.data()).velocity;
  }
  return 0.5 * (a + a.transpose());
}

// Refuses momenta of so many coordinates, directions and free lines that are no surface, and no
// curve of the plane.
void check_surface(Eigen::Index n, Eigen::Index rank, Eigen::Index left) {
  const Eigen::Index wanted = n == 2 ? 1 : 2;
  if (rank <= 3 && left >= 0 && left <= 1 && rank - 1 + left == wanted) return;
  const auto fix = n - 1 - wanted;
  throw std::invalid_argument(
      rank - 1 > wanted
          ? "momenta of unit speed have too many dimensions for a surface: the rank is " +
                std::to_string(rank) + ", and at most three directions are admissible"
          : "momenta of unit speed are no surface: the rank is " + std::to_string(rank) + ", and " +
                std::to_string(fix) + " momenta are to be fixed");
}

// Orthonormal columns that the rows map to zero: what is left of as many as the rows have columns.
MatrixXd kernel_of(const MatrixXd& rows, Eigen::Index left) {
  if (left == 1) return *kernel_line(rows, kRank);
  return right_singular(rows).vectors.rightCols(left);
}

}  // namespace

UnitMomentum between(const UnitMomentum& a, const UnitMomentum& b, double part) {
  UnitMomentum place;
  place.c = ((1 - part) * a.c + part * b.c).normalized();
  place.w = a.w + part * (b.w - a.w);
  return place;
}

UnitMomenta::UnitMomenta(const Dynamics& dynamics,
                         const std::vector<double>& from,
                         const std::vector<std::pair<int, double>>& conditions,
                         bool condition_on_ends) {
  const int n = dynamics.dof;
  const SymmetricEigen eigen = symmetric_eigen(metric_at(dynamics, from));
  const auto rank = (eigen.values.array() > kRank * eigen.values.maxCoeff()).count();
  const auto m = static_cast<Eigen::Index>(conditions.size());
  const auto left = n - rank - m;
  if (condition_on_ends) {
    if (rank != 2 || left != 2) {
      throw std::invalid_argument(
          "a condition on the ends leaves a surface where two directions are admissible and two "
          "momenta beside them are free; here these are " +
          std::to_string(rank) + " and " + std::to_string(left));
    }
  } else {
    check_surface(n, rank, left);
  }
  const VectorXd root = eigen.values.tail(rank).cwiseSqrt();
  circle_ = eigen.vectors.rightCols(rank) * root.cwiseInverse().asDiagonal();
  on_circle_ = root.asDiagonal() * eigen.vectors.rightCols(rank).transpose();
  const MatrixXd kernel = eigen.vectors.leftCols(n - rank);
  slope_ = MatrixXd::Zero(n, rank);
  base_ = VectorXd::Zero(n);
  if (m == 0) {
    lines_ = kernel;
  } else {
    MatrixXd rows(m, n);
    rows.setZero();
    VectorXd values(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      rows(i, conditions[i].first) = 1;
      values[i] = conditions[i].second;
    }
    const MatrixXd fixed = rows * kernel;
    if (!(singular_values(fixed).minCoeff() > kRank)) {
      throw std::invalid_argument("the fixed momenta do not move along the kernel of H");
    }
    if (left > 0) lines_ = kernel * kernel_of(fixed, left);
    base_ = kernel * least_squares(fixed, values, kRank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      slope_.col(k) = -kernel * least_squares(fixed, rows * circle_.col(k), kRank);
    }
  }
  // The sign of an eigenvector is arbitrary.
  for (Eigen::Index k = 0; k < left; ++k) {
    Eigen::Index largest = 0;
    lines_.col(k).cwiseAbs().maxCoeff(&largest);
    if (lines_(largest, k) < 0) lines_.col(k) *= -1;
  }
  on_lines_ = lines_.transpose();
}

void UnitMomenta::set_plane(const Eigen::Matrix2d& axes) {
  lines_ = lines_ * axes;
  on_lines_ = axes.inverse() * on_lines_;
}

VectorXd UnitMomenta::around(const Eigen::Vector3d& c) const {
  return base_ + (circle_ + slope_) * c.head(rank());
}

std::vector<double> UnitMomenta::momentum(const UnitMomentum& place) const {
  VectorXd p = around(place.c);
  if (has_line()) p += lines_ * place.w.head(lines());
  return {p.data(), p.data() + p.size()};
}

UnitMomentum UnitMomenta::place(const std::vector<double>& p) const {
  const Eigen::Map<const VectorXd> at(p.data(), static_cast<Eigen::Index>(p.size()));
  UnitMomentum place;
  place.c.head(rank()) = (on_circle_ * at).normalized();
  if (has_line()) place.w.head(lines()) = on_lines_ * (at - around(place.c));
  return place;
}

std::array<UnitMomentum, 2> UnitMomenta::ways(const UnitMomentum& at) const {
  if (has_line()) {
    const Eigen::Vector3d along(-at.c[1], at.c[0], 0);
    return {UnitMomentum{along, Eigen::Vector2d::Zero()},
            UnitMomentum{Eigen::Vector3d::Zero(), Eigen::Vector2d::UnitX()}};
  }
  Eigen::Index least = 0;
  at.c.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d one = at.c.cross(Eigen::Vector3d::Unit(least)).normalized();
  return {UnitMomentum{one}, UnitMomentum{at.c.cross(one)}};
}

VectorXd UnitMomenta::tangent(const UnitMomentum& at, const UnitMomentum& way) const {
  const Eigen::Vector3d across = way.c - at.c.dot(way.c) * at.c;
  VectorXd dp = (circle_ + slope_) * across.head(rank());
  if (has_line()) dp += lines_ * way.w.head(lines());
  return dp;
}

std::vector<Eigen::Vector3d> UnitMomenta::directions(int count) const {
  std::vector<Eigen::Vector3d> all;
  for (int k = 0; k < count; ++k) {
    constexpr double kGolden = 2.399963229728653;  // radians: the places of a sunflower's seeds
    const double height = rank() == 3 ? 1 - (2 * k + 1.0) / count : 0;
    const double phi = rank() == 3 ? kGolden * k : 2 * std::numbers::pi * (k + 0.37) / count;
    const double across = std::sqrt(1 - height * height);
    Eigen::Vector3d c(across * std::cos(phi), across * std::sin(phi), height);
    if (rank() == 1) c = {k % 2 == 0 ? 1.0 : -1.0, 0, 0};
    all.push_back(c);
  }
  return all;
}

}  // namespace carnot::internal
