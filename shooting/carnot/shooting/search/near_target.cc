#include "carnot/shooting/search/near_target.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/shooting/path/discrete_newton.h"
#include "carnot/shooting/path/relaxation.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Column i: node i in the coordinates of the dilation, beside the straight line to the end.
MatrixXd beside_line(const Dilation& dilation, const Path& path) {
  const VectorXd end = dilation.coordinates(path.configuration(path.intervals));
  MatrixXd y(path.dof, path.intervals + 1);
  for (int i = 0; i <= path.intervals; ++i) {
    const double share = static_cast<double>(i) / path.intervals;
    y.col(i) = dilation.coordinates(path.configuration(i)) - share * end;
  }
  return y;
}

// A discrete extremal near `path`: by Newton's method or, where the path is too far from the
// constraints for it, by relaxing first.
bool settle(const BoundaryValueProblem& problem, Path& path) {
  DiscreteNewtonOptions newton;
  newton.max_iterations = 30;
  Path trial = path;
  bool settled = tighten(problem, newton, trial).converged;
  if (!settled) {
    RelaxationOptions relaxation;
    relaxation.outer_iterations = 4;
    relaxation.penalty = 100;
    trial = path;
    relax(problem, relaxation, trial);
    settled = tighten(problem, newton, trial).converged;
  }
  if (settled) path = std::move(trial);
  return settled;
}

}  // namespace

std::optional<NearTarget> NearTarget::of(const BoundaryValueProblem& problem) {
  constexpr double kEasy = 0.03;  // displacement in units of S that relaxation reaches
  constexpr double kWorthIt = 1.1;
  if (!problem.dynamics.has_transcription() || problem.has_free_ends()) return std::nullopt;
  auto dilation = Dilation::at_start(problem);
  if (!dilation) return std::nullopt;
  const VectorXd y = dilation->coordinates(problem.to.data());
  const auto factor = [&](double share) {
    return std::pow(share, 1.0 / dilation->weights().back());
  };
  const double dilated = factor(kEasy) / dilation->gauge(y);
  const double stretched = factor(kEasy * dilation->unit() / y.norm());
  if (!(dilated > kWorthIt) || !std::isfinite(dilated)) return std::nullopt;
  return NearTarget(problem, std::move(*dilation), dilated, std::max(1.0, stretched));
}

NearTarget::Way NearTarget::way(int start) const {
  if (start / 2 % 2 == 1) return {stretched_, true};
  return {start / 4 % 2 == 0 ? dilated_ : std::max(1.0, 0.5 * dilated_), false};
}

BoundaryValueProblem NearTarget::easy(const Way& way) const {
  if (way.factor == 1) return problem_;
  BoundaryValueProblem far = problem_;
  const VectorXd y = dilation_.coordinates(problem_.to.data());
  const double all = std::pow(way.factor, dilation_.weights().back());
  dilation_.place(way.straight ? VectorXd(all * y) : dilation_.scaled(y, way.factor),
                  far.to.data());
  return far;
}

bool NearTarget::shrink(Way way, Path& path) const {
  constexpr double kLongest = 0.5;  // step of the dilation, as a factor,
  constexpr double kShortest = 0.95;
  const int n = path.dof;
  std::vector<double> exponent(dilation_.weights().begin(), dilation_.weights().end());
  for (double step = kLongest; way.factor > 1;) {
    const Way next{std::max(1.0, way.factor * step), way.straight};
    const BoundaryValueProblem nearer = easy(next);
    const double part = next.factor / way.factor;
    const VectorXd end = dilation_.coordinates(nearer.to.data());
    const MatrixXd beside = beside_line(dilation_, path);
    VectorXd ratio(n);
    for (int j = 0; j < n; ++j) ratio[j] = std::pow(part, exponent[j]);
    Path trial = path;
    for (int i = 1; i < path.intervals; ++i) {
      const double share = static_cast<double>(i) / path.intervals;
      dilation_.place(share * end + ratio.cwiseProduct(beside.col(i)), trial.configuration(i));
    }
    std::copy(nearer.to.begin(), nearer.to.end(), trial.configuration(path.intervals));
    if (!settle(nearer, trial)) {
      if (step > kShortest) return false;
      step = std::sqrt(step);
      continue;
    }
    const MatrixXd reached = beside_line(dilation_, trial);
    for (int j = 0; j < n; ++j) {
      const double shrunk =
          reached.row(j).cwiseAbs().maxCoeff() / beside.row(j).cwiseAbs().maxCoeff();
      if (!(shrunk > 0)) continue;  // zero or NaN: the coordinate does not leave the line
      exponent[j] = std::clamp(std::log(shrunk) / std::log(part), 0.0, 5.0);
    }
    path = std::move(trial);
    way = next;
    step = std::max(kLongest, step * step);
  }
  return true;
}

}  // namespace carnot::internal
