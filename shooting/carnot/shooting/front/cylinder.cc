#include "carnot/shooting/front/cylinder.h"

#include <cmath>
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

Cylinder::Cylinder(const Dynamics& dynamics,
                   const std::vector<double>& from,
                   const std::vector<std::pair<int, double>>& conditions) {
  const int n = dynamics.dof;
  const SymmetricEigen eigen = symmetric_eigen(metric_at(dynamics, from));
  const auto rank = (eigen.values.array() > kRank * eigen.values.maxCoeff()).count();
  const auto left = n - rank - static_cast<Eigen::Index>(conditions.size());
  if (rank != 2 || left != 1) {
    throw std::invalid_argument(
        "momenta of unit speed are a circle times a line only where two directions are admissible "
        "and all but one of the other momenta are fixed: the rank is " +
        std::to_string(rank) + ", and " + std::to_string(n - rank - 1) +
        " momenta are to be fixed");
  }
  const VectorXd root = eigen.values.tail(rank).cwiseSqrt();
  circle_ = eigen.vectors.rightCols(rank) * root.cwiseInverse().asDiagonal();
  on_circle_ = root.asDiagonal() * eigen.vectors.rightCols(rank).transpose();
  const MatrixXd kernel = eigen.vectors.leftCols(n - rank);
  const auto m = static_cast<Eigen::Index>(conditions.size());
  slope_ = MatrixXd::Zero(n, rank);
  base_ = VectorXd::Zero(n);
  if (m == 0) {
    line_ = kernel.col(0);
  } else {
    MatrixXd rows(m, n);
    rows.setZero();
    VectorXd values(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      rows(i, conditions[i].first) = 1;
      values[i] = conditions[i].second;
    }
    const MatrixXd fixed = rows * kernel;
    const auto line = kernel_line(fixed, kRank);
    if (!line) throw std::invalid_argument("the fixed momenta do not move along the kernel of H");
    line_ = kernel * *line;
    base_ = kernel * least_squares(fixed, values, kRank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      slope_.col(k) = -kernel * least_squares(fixed, rows * circle_.col(k), kRank);
    }
  }
  // The sign of an eigenvector is arbitrary.
  Eigen::Index largest = 0;
  line_.cwiseAbs().maxCoeff(&largest);
  if (line_[largest] < 0) line_ = -line_;
}

VectorXd Cylinder::around(double phi) const {
  const Eigen::Vector2d c(std::cos(phi), std::sin(phi));
  return base_ + (circle_ + slope_) * c;
}

std::vector<double> Cylinder::momentum(double phi, double w) const {
  const VectorXd p = around(phi) + w * line_;
  return {p.data(), p.data() + p.size()};
}

std::pair<double, double> Cylinder::coordinates(const std::vector<double>& p) const {
  const Eigen::Map<const VectorXd> at(p.data(), static_cast<Eigen::Index>(p.size()));
  const VectorXd c = on_circle_ * at;
  const double phi = std::atan2(c[1], c[0]);
  return {phi, line_.dot(at - around(phi))};
}

}  // namespace carnot::internal
