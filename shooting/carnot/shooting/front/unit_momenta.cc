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

}  // namespace

UnitMomentum between(const UnitMomentum& a, const UnitMomentum& b, double part) {
  UnitMomentum place;
  place.c = ((1 - part) * a.c + part * b.c).normalized();
  place.w = a.w + part * (b.w - a.w);
  return place;
}

UnitMomenta::UnitMomenta(const Dynamics& dynamics,
                         const std::vector<double>& from,
                         const std::vector<std::pair<int, double>>& conditions) {
  const int n = dynamics.dof;
  const SymmetricEigen eigen = symmetric_eigen(metric_at(dynamics, from));
  const auto rank = (eigen.values.array() > kRank * eigen.values.maxCoeff()).count();
  const auto m = static_cast<Eigen::Index>(conditions.size());
  const auto left = n - rank - m;
  const Eigen::Index wanted = n == 2 ? 1 : 2;
  if (rank > 3 || left < 0 || left > 1 || rank - 1 + left != wanted) {
    const auto fix = n - 1 - wanted;
    throw std::invalid_argument(
        rank - 1 > wanted
            ? "momenta of unit speed have too many dimensions for a surface: the rank is " +
                  std::to_string(rank) + ", and at most three directions are admissible"
            : "momenta of unit speed are no surface: the rank is " + std::to_string(rank) +
                  ", and " + std::to_string(fix) + " momenta are to be fixed");
  }
  const VectorXd root = eigen.values.tail(rank).cwiseSqrt();
  circle_ = eigen.vectors.rightCols(rank) * root.cwiseInverse().asDiagonal();
  on_circle_ = root.asDiagonal() * eigen.vectors.rightCols(rank).transpose();
  const MatrixXd kernel = eigen.vectors.leftCols(n - rank);
  slope_ = MatrixXd::Zero(n, rank);
  base_ = VectorXd::Zero(n);
  if (m == 0) {
    if (left == 1) line_ = kernel.col(0);
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
    if (left == 1) line_ = kernel * *kernel_line(fixed, kRank);
    base_ = kernel * least_squares(fixed, values, kRank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      slope_.col(k) = -kernel * least_squares(fixed, rows * circle_.col(k), kRank);
    }
  }
  // The sign of an eigenvector is arbitrary.
  if (left == 0) return;
  Eigen::Index largest = 0;
  line_.cwiseAbs().maxCoeff(&largest);
  if (line_[largest] < 0) line_ = -line_;
}

VectorXd UnitMomenta::around(const Eigen::Vector3d& c) const {
  return base_ + (circle_ + slope_) * c.head(rank());
}

std::vector<double> UnitMomenta::momentum(const UnitMomentum& place) const {
  VectorXd p = around(place.c);
  if (has_line()) p += place.w * line_;
  return {p.data(), p.data() + p.size()};
}

UnitMomentum UnitMomenta::place(const std::vector<double>& p) const {
  const Eigen::Map<const VectorXd> at(p.data(), static_cast<Eigen::Index>(p.size()));
  UnitMomentum place;
  place.c.head(rank()) = (on_circle_ * at).normalized();
  if (has_line()) place.w = line_.dot(at - around(place.c));
  return place;
}

std::array<UnitMomentum, 2> UnitMomenta::ways(const UnitMomentum& at) const {
  if (has_line()) {
    const Eigen::Vector3d along(-at.c[1], at.c[0], 0);
    return {UnitMomentum{along, 0}, UnitMomentum{Eigen::Vector3d::Zero(), 1}};
  }
  Eigen::Index least = 0;
  at.c.cwiseAbs().minCoeff(&least);
  const Eigen::Vector3d one = at.c.cross(Eigen::Vector3d::Unit(least)).normalized();
  return {UnitMomentum{one, 0}, UnitMomentum{at.c.cross(one), 0}};
}

VectorXd UnitMomenta::tangent(const UnitMomentum& at, const UnitMomentum& way) const {
  const Eigen::Vector3d across = way.c - at.c.dot(way.c) * at.c;
  VectorXd dp = (circle_ + slope_) * across.head(rank());
  if (has_line()) dp += way.w * line_;
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
