#include "carnot/shooting/extremal/step_maps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "carnot/numerics/linear_algebra.h"
#include "carnot/shooting/linear/dense.h"

namespace carnot::internal {
namespace {

using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Steps of a block: of twelve coordinates they take 1.2 MB.
constexpr long kBlock = 256;

bool on_manifold(const Dynamics& dynamics) { return dynamics.forced > 0 && !dynamics.on_leaves; }

// The directions Dh' at a phase point, orthonormal: vectors (a, 0) that are normal to the manifold
// {h = 0, Dh H_p = 0}.
MatrixXd normals_at(const Dynamics& dynamics, double t, std::span<const double> z) {
  const int n = dynamics.dof;
  RowMajor projector(2 * n, 2 * n);
  if (!dynamics.tangent_projector(t, z, span_of(projector))) {
    projector.setConstant(std::nan(""));
  }
  return right_singular(projector.leftCols(n)).vectors.rightCols(dynamics.forced);
}

// The map of planes that belongs to the tangent m of a step from z at time t to `end` at t + h.
// Not finite where there is none.
MatrixXd map_of(const Dynamics& dynamics,
                const Units& units,
                double t,
                double h,
                std::span<const double> z,
                std::span<const double> end,
                const double* m) {
  const int n = dynamics.dof;
  MatrixXd map = Eigen::Map<const RowMajor>(m, 2 * n, 2 * n);
  if (on_manifold(dynamics)) {
    const MatrixXd before = normals_at(dynamics, t, z);
    const MatrixXd after = normals_at(dynamics, t + h, end);
    map.bottomRightCorner(n, n) += product(after, before.transpose());
  }
  return units.map(std::move(map));
}

}  // namespace

bool take_step(const Dynamics& dynamics, const Units& units, double t, double h, StepMap& step) {
  const std::vector<double> before = step.z;
  std::vector<double> m(before.size() * before.size());
  if (!dynamics.tangent_flow(StepPlan::equal(t, h, 1), step.z, m).completed()) return false;
  step.map = map_of(dynamics, units, t, h, before, step.z, m.data());
  return step.map.allFinite();
}

StepMaps::StepMaps(const BoundaryValueProblem& problem,
                   const Units& units,
                   const Knots& knots,
                   long per_segment)
    : problem_(problem), units_(units), knots_(knots), per_segment_(per_segment) {
  const std::size_t size = 2 * static_cast<std::size_t>(knots.dof);
  const auto kept = static_cast<std::size_t>(std::min(kBlock, count()));
  nodes_.resize((kept + 1) * size);
  tangents_.resize(kept * size * size);
}

const double* StepMaps::before(long i) const {
  if (i % per_segment_ == 0) return knots_.at(static_cast<int>(i / per_segment_));
  return &nodes_[(i - first_) * 2 * knots_.dof];
}

const double* StepMaps::after(long i) const { return &nodes_[(i - first_ + 1) * 2 * knots_.dof]; }

void StepMaps::fill(long first) {
  const long size = 2L * knots_.dof;
  const bool follows = first == 0 || done_ == kBlock;
  if (first > 0) std::copy_n(&nodes_[kBlock * size], size, nodes_.data());
  first_ = first;
  done_ = 0;
  const long end = std::min(first + kBlock, count());
  const double h = problem_.time / static_cast<double>(count());
  for (long i = first; follows && i < end;) {
    const long steps = std::min(end - i, per_segment_ - i % per_segment_);  // in one segment
    std::vector<double> z(before(i), before(i) + size);
    const auto plan =
        StepPlan::equal(static_cast<double>(i) * h, static_cast<double>(steps) * h, steps);
    const std::span nodes(&nodes_[(i - first + 1) * size], steps * size);
    const std::span tangents(&tangents_[(i - first) * size * size], steps * size * size);
    std::fill(tangents.begin(), tangents.end(), std::nan(""));  // of a step without one it stays
    const long taken = problem_.dynamics.tangent_steps(plan, z, nodes, tangents).steps;
    done_ += taken;
    if (taken < steps) return;
    i += steps;
  }
}

bool StepMaps::read(long i, StepMap& step) {
  if (first_ < 0 || i < first_) fill(0);
  while (i >= first_ + kBlock) fill(first_ + kBlock);
  if (i - first_ >= done_) return false;
  const int size = 2 * knots_.dof;
  const std::span from(before(i), size);
  const std::span to(after(i), size);
  const double t = end(i - 1);
  const bool at_knot = (i + 1) % per_segment_ == 0;
  const double* end_of_step =
      at_knot ? knots_.at(static_cast<int>((i + 1) / per_segment_)) : to.data();
  step.z.assign(end_of_step, end_of_step + size);
  step.map = map_of(
      problem_.dynamics, units_, t, end(i) - t, from, to, &tangents_[(i - first_) * size * size]);
  return step.map.allFinite();
}

bool JoinedSteps::read(long i, StepMap& step) const {
  if (!steps_.read(i * together_, step)) return false;
  StepMap next;
  for (int j = 1; j < together_; ++j) {
    if (!steps_.read(i * together_ + j, next)) return false;
    step.z = next.z;
    step.map = product(next.map, step.map);
  }
  return true;
}

}  // namespace carnot::internal
