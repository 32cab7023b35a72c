#include "carnot/shooting/continue/solution_curve.h"

#include <cmath>
#include <limits>
#include <utility>

#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFullRank = 1e-11;  // of the least over the largest pivot

MatrixXd bordered(const MatrixXd& jacobian, const VectorXd& row) {
  MatrixXd matrix(row.size(), row.size());
  matrix << jacobian, row.transpose();
  return matrix;
}

// The cubic through both points with their tangents.
VectorXd between(const CurvePoint& a, const CurvePoint& b, double share) {
  const double length = (b.x - a.x).norm();
  const double rest = 1 - share;
  return rest * rest * (1 + 2 * share) * a.x + share * share * (3 - 2 * share) * b.x +
         length * share * rest * (rest * a.tangent - share * b.tangent);
}

}  // namespace

bool SolutionCurve::finish(const MatrixXd& jacobian, const VectorXd& along, CurvePoint& point) {
  const auto size = along.size();
  point.tangent = lu_solve(bordered(jacobian, along), VectorXd::Unit(size, size - 1));
  if (!point.tangent.allFinite()) return false;
  point.tangent.normalize();
  const Determinant determinant = determinant_of(bordered(jacobian, point.tangent));
  point.orientation = determinant.sign;
  point.log_determinant = determinant.log_size;
  return true;
}

std::optional<CurvePoint> SolutionCurve::correct(VectorXd x,
                                                 const VectorXd& row,
                                                 const VectorXd& along) {
  constexpr int kMaxIterations = 8;
  constexpr double kSmall = 1e-9;  // after such a step the next one would be round-off
  constexpr double kContracts = 0.7;
  const VectorXd predicted = x;
  CurvePoint point;
  VectorXd residual;
  MatrixXd jacobian;
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations; ++i) {
    if (!equations_.evaluate(x, residual, jacobian)) return std::nullopt;
    if (last <= kSmall) {
      point.x = std::move(x);
      if (!finish(jacobian, along, point)) return std::nullopt;
      return point;
    }
    VectorXd right(x.size());
    right << residual, row.dot(x - predicted);
    const VectorXd step = lu_solve(bordered(jacobian, row), right);
    const double length = step.norm();
    if (!(length < kContracts * last)) return std::nullopt;  // or not a number
    if (i == 0) point.distance = length;
    if (i == 1) point.contraction = length / last;
    last = length;
    x -= step;
  }
  return std::nullopt;
}

std::optional<CurvePoint> SolutionCurve::start(const VectorXd& x, const VectorXd& along) {
  VectorXd residual;
  MatrixXd jacobian;
  if (!equations_.evaluate(x, residual, jacobian)) return std::nullopt;
  const auto kernel = kernel_line(jacobian, kFullRank);
  if (!kernel) return std::nullopt;
  const double sign = kernel->dot(along) < 0 ? -1 : 1;
  return correct(x, sign * *kernel, sign * *kernel);
}

VectorXd SolutionCurve::locate(const CurvePoint& a, const CurvePoint& b, const Test& test) {
  constexpr int kMaxIterations = 40;
  constexpr double kClose = 1e-9;
  constexpr double kZero = 1e-11;
  const double enough = kZero * std::abs(test(b) - test(a));
  CurvePoint low = a;
  CurvePoint high = b;
  double at_low = test(low);
  double at_high = test(high);
  int side = 0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const VectorXd chord = high.x - low.x;
    const double length = chord.norm();
    if (!(length > kClose) || std::abs(at_low) <= enough || std::abs(at_high) <= enough) break;
    // Just at a branch point Newton's method does not converge; beside it, it does.
    const double share = at_low / (at_low - at_high);
    std::optional<CurvePoint> middle;
    for (const double trial : {share, 0.5 * share, 0.5 + 0.5 * share}) {
      if (!middle) middle = correct(low.x + trial * chord, chord / length, chord);
    }
    if (!middle) break;
    const double at_middle = test(*middle);
    const bool same = (at_middle > 0) == (at_low > 0);
    (same ? low : high) = *middle;
    (same ? at_low : at_high) = at_middle;
    // The value at an end that stays is halved, so that the end moves before long.
    if (side == (same ? 1 : -1)) (same ? at_high : at_low) *= 0.5;
    side = same ? 1 : -1;
  }
  at_low = test(low);
  at_high = test(high);
  const double share = at_low == at_high ? 0 : at_low / (at_low - at_high);
  return between(low, high, share);
}

std::optional<VectorXd> SolutionCurve::locate_touch(const CurvePoint& a, const CurvePoint& b) {
  constexpr int kMaxIterations = 40;
  constexpr double kGolden = 0.3819660112501051;
  // Of the chord. At the distance tau the determinant tells the point to tau^2, and what Newton's
  // method leaves moves it by round-off over tau: 1e-5 and 1e-6 were measured to be 1e-12 off, 1e-7
  // was 1e-7 off.
  constexpr double kClose = 1e-5;
  // A determinant that falls by this factor touches zero: Newton's method ends beside the point.
  constexpr double kVanishes = 1e-6;
  const VectorXd chord = b.x - a.x;
  double low = 0;
  double least = kGolden;
  double high = 1;
  CurvePoint at_low = a;
  CurvePoint at_high = b;
  // The nearer the singular Jacobian, the better must the guess be.
  const auto at = [&](double share) {
    const VectorXd guess = between(at_low, at_high, (share - low) / (high - low));
    return correct(guess, chord.normalized(), chord);
  };
  auto at_least = at(least);
  for (int i = 0; at_least && high - low > kClose && i < kMaxIterations; ++i) {
    const bool right = high - least > least - low;
    const double share = least + kGolden * (right ? high - least : low - least);
    const auto trial = at(share);
    if (!trial) break;
    const bool lower = trial->log_determinant < at_least->log_determinant;
    (lower == right ? low : high) = lower ? least : share;
    (lower == right ? at_low : at_high) = lower ? *at_least : *trial;
    if (!lower) continue;
    least = share;
    at_least = trial;
  }
  const double outside = std::min(a.log_determinant, b.log_determinant);
  if (!at_least || at_least->log_determinant > outside + std::log(kVanishes)) return std::nullopt;
  const double falls = std::exp(0.5 * (at_low.log_determinant - outside));
  const double rises = std::exp(0.5 * (at_high.log_determinant - outside));
  return between(at_low, at_high, falls / (falls + rises));
}

std::optional<VectorXd> SolutionCurve::other_direction(const VectorXd& x, const VectorXd& tangent) {
  VectorXd residual;
  MatrixXd jacobian;
  if (!equations_.evaluate(x, residual, jacobian)) return std::nullopt;
  VectorXd direction = right_singular(bordered(jacobian, tangent)).vectors.col(x.size() - 1);
  direction -= direction.dot(tangent) * tangent;
  return direction.normalized();
}

}  // namespace carnot::internal
