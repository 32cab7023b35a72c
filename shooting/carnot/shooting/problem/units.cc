#include "carnot/shooting/problem/units.h"

#include <cmath>
#include <span>
#include <vector>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/problem/dilation.h"
#include "carnot/shooting/problem/ends.h"
#include "carnot/shooting/problem/scales.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The length of the extremal where there is no potential: |q'| T.
double length_of(const BoundaryValueProblem& problem, const std::vector<double>& p0) {
  const Dynamics& dynamics = problem.dynamics;
  std::vector<double> velocity(dynamics.dof), lambda(dynamics.multipliers);
  const std::vector<double> zero(dynamics.dof, 0.0);
  const auto energy = [&](std::span<const double> p) {
    return dynamics.evaluate(0, problem.from, p, velocity, lambda).hamiltonian;
  };
  return problem.time * std::sqrt(2 * (energy(p0) - energy(zero)));
}

}  // namespace

Units::Units(const BoundaryValueProblem& problem, const std::vector<double>& x) {
  constexpr double kShort = 0.1;  // of a radian
  if (problem.has_free_ends()) {
    const int dof = problem.dynamics.dof;
    const double unit = length_per_momentum(problem, phase_point(problem, x).data() + dof);
    start_.setOnes(dof);
    target_.setOnes(dof);
    for (int j = 0; j < dof; ++j) {
      if (problem.is_free_from(j)) start_[j] = unit;
      if (problem.is_free_to(j)) target_[j] = unit;
    }
    return;
  }
  if (!problem.dynamics.has_transcription()) return;
  const double length = length_of(problem, x);
  const double unit = start_scales(problem).radian;
  if (!(length > 0 && length < kShort * unit)) return;
  const auto dilation = Dilation::at_start(problem);
  if (!dilation) return;
  const int n = dilation->dof();
  e_.resize(n, n);
  for (int j = 0; j < n; ++j) {
    e_.col(j) = unit * std::pow(length / unit, dilation->weights()[j]) * dilation->basis().col(j);
  }
  inverse_ = lu_inverse(e_);
  c_ = length * length / problem.time;
  scaled_ = true;
}

MatrixXd Units::map(MatrixXd m) const {
  if (!scaled_) return m;
  const auto n = e_.rows();
  MatrixXd scaled(2 * n, 2 * n);
  scaled.leftCols(n) = product(m.leftCols(n), e_);
  scaled.rightCols(n) = c_ * product(m.rightCols(n), inverse_.transpose());
  scaled.topRows(n) = product(inverse_, scaled.topRows(n));
  scaled.bottomRows(n) = transposed_product(e_, scaled.bottomRows(n)) / c_;
  return scaled;
}

MatrixXd Units::tangent(const MatrixXd& columns) const {
  const auto n = columns.cols();
  if (start_.size() > 0) {
    MatrixXd scaled = columns * start_.asDiagonal();
    scaled.topRows(n) = target_.asDiagonal() * scaled.topRows(n);
    scaled.bottomRows(n) = target_.cwiseInverse().asDiagonal() * scaled.bottomRows(n);
    return scaled;
  }
  if (!scaled_) return columns;
  MatrixXd scaled = c_ * product(columns, inverse_.transpose());
  scaled.topRows(n) = product(inverse_, scaled.topRows(n));
  scaled.bottomRows(n) = transposed_product(e_, scaled.bottomRows(n)) / c_;
  return scaled;
}

double Units::size(const VectorXd& p) const {
  if (start_.size() > 0) return p.cwiseQuotient(start_).norm();
  return scaled_ ? (e_.transpose() * p / c_).norm() : p.norm();
}

VectorXd Units::displacement(const VectorXd& q) const {
  if (start_.size() > 0) return q.cwiseProduct(target_);
  return scaled_ ? VectorXd(inverse_ * q) : q;
}

MatrixXd Units::momenta(const MatrixXd& p) const {
  if (start_.size() > 0) return start_.asDiagonal() * p;
  return scaled_ ? MatrixXd(c_ * transposed_product(inverse_, p)) : p;
}

}  // namespace carnot::internal
