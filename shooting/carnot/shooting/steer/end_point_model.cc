#include "carnot/shooting/steer/end_point_model.h"

#include <algorithm>
#include <limits>

#include "carnot/shooting/shoot/end_point.h"

namespace carnot::internal {
EndPointModel::EndPointModel(const BoundaryValueProblem& problem, const Vector& p0) {
  constexpr double kSingular = 1e-11;
  // Of p0, for differences. With 1e-4, 3e-4 and 1e-3 warm starts near the parking vehicle
  // take 2.49, 3.11 and 4.59 flows for 2.38.
  constexpr double kAside = 3e-5;
  const Eigen::Index n = p0.size();
  const auto jacobian_at = [&](const Vector& aside) -> Matrix {
    const Vector moved = p0 + aside;
    std::vector<double> z;
    const auto tangent =
        end_point_tangent(problem, {moved.data(), moved.data() + n}, problem.time, kSteps, z);
    if (!tangent) return Matrix::Constant(n, n, std::numeric_limits<double>::quiet_NaN());
    return tangent->topRows(n);
  };
  jacobian_ = jacobian_at(Vector::Zero(n));
  if (!jacobian_.allFinite()) return;
  const auto inverse = inverse_if_regular(jacobian_, kSingular);
  if (!inverse) return;
  inverse_ = *inverse;
  const double h = kAside * p0.cwiseAbs().maxCoeff();
  const auto second = [&](const Matrix& after, const Matrix& before) -> Matrix {
    return (after + before - 2 * jacobian_) / (h * h);
  };
  std::vector<Matrix> pure;
  for (Eigen::Index j = 0; j < n; ++j) {
    const Vector along_j = h * Vector::Unit(n, j);
    const Matrix after = jacobian_at(along_j);
    const Matrix before = jacobian_at(-along_j);
    bend_.emplace_back((after - before) / (2 * h));
    pure.push_back(second(after, before));
    // Along both i and j the difference is that of i, of j, and twice the mixed one.
    for (Eigen::Index i = 0; i < j; ++i) {
      const Vector along_both = along_j + h * Vector::Unit(n, i);
      twist_.emplace_back(second(jacobian_at(along_both), jacobian_at(-along_both)) - pure[i] -
                          pure[j]);
    }
    twist_.push_back(pure[j]);
  }
  const auto finite = [](const Matrix& m) { return m.allFinite(); };
  invertible_ = std::all_of(twist_.begin(), twist_.end(), finite);
}

bool EndPointModel::solve(const Vector& change, Prediction& at) const {
  constexpr int kMostIterations = 4;
  constexpr double kClose = 1e-3;  // of the change of p0: the model is no better
  const Eigen::Index n = jacobian_.rows();
  Vector& x = at.change;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    // With B = sum_j x_j dJ/dp_j and C = sum_ij x_i x_j d2J/dp_i dp_j the end moves by
    // J x + B x / 2 + C x / 6; the derivative of that is J + B + C / 2.
    Matrix bend = Matrix::Zero(n, n);
    Matrix twist = Matrix::Zero(n, n);
    auto of_pair = twist_.begin();
    for (Eigen::Index j = 0; j < n; ++j) {
      bend += x[j] * bend_[j];
      for (Eigen::Index i = 0; i <= j; ++i) twist += x[i] * x[j] * *of_pair++;
    }
    const Vector linear = jacobian_.lazyProduct(x);
    const Vector square = bend.lazyProduct(x) / 2;
    const Vector cube = twist.lazyProduct(x) / 6;
    const Matrix slope = jacobian_ + bend + twist / 2;
    const Vector step = small_lu_solve(slope, linear + square + cube - change);
    x -= step;
    if (!(step.norm() <= x.norm())) return false;
    if (step.norm() > kClose * x.norm()) continue;
    at.inverse = small_lu_inverse(slope);
    // The error is the next term of a series that goes on as it began.
    const double second = square.cwiseAbs().maxCoeff();
    const double third = cube.cwiseAbs().maxCoeff();
    at.error = second > 0 ? third * third / second : 0;
    return true;
  }
  return false;
}

EndPointModel::Prediction EndPointModel::move_end(const Vector& change) const {
  constexpr double kShortest = 1.0 / 32;  // stride; where it is too long the model has a fold
  Prediction reached{Vector::Zero(jacobian_.rows()), inverse_, change.cwiseAbs().maxCoeff()};
  double part = 0;
  for (double stride = 1; part < 1 && stride >= kShortest;) {
    const double next = std::min(1.0, part + stride);
    Prediction trial = reached;
    if (solve(next * change, trial)) {
      reached = trial;
      part = next;
    } else {
      stride /= 2;
    }
  }
  if (part < 1) reached.error = std::max(reached.error, (1 - part) * change.cwiseAbs().maxCoeff());
  return reached;
}

}  // namespace carnot::internal
