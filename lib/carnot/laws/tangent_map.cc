#include "carnot/laws/tangent_map.h"

#include <Eigen/Core>
#include <algorithm>

#include "carnot/numerics/canonical_structure.h"
#include "carnot/numerics/linear_algebra.h"

namespace carnot {
namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// T'A T. Sums entry by entry: Eigen's product for large matrices takes the compiler seconds.
Square congruent(const Square& t, const Square& a) {
  const Square at = a.lazyProduct(t);
  return t.transpose().lazyProduct(at);
}

// Steps `first`, ..., `last` - 1 of the plan.
StepPlan piece(const StepPlan& plan, long first, long last) {
  const double ending = last == plan.count ? plan.last : plan.step;
  return {plan.time(first), plan.time(last), plan.step, ending, last - first};
}

}  // namespace

TangentMap tangent_along(const Dynamics& dynamics,
                         const StepPlan& plan,
                         std::vector<double> z,
                         const Progress& progress) {
  constexpr long kPiece = 4096;  // steps between two calls of `progress`
  const int n = dynamics.dof;
  const std::vector<double> start = z;
  TangentMap map;
  Square m = Square::Identity(2 * n, 2 * n);
  for (long first = 0; first < plan.count && map.status == FlowStatus::kCompleted;) {
    const long last = std::min(plan.count, first + kPiece);
    Square factor(2 * n, 2 * n);
    map.status = dynamics.tangent_flow(piece(plan, first, last), z, span_of(factor)).status;
    m = factor.lazyProduct(m).eval();
    first = last;
    const double fraction = static_cast<double>(last) / static_cast<double>(plan.count);
    if (progress && !progress(fraction)) map.status = FlowStatus::kStopped;
  }
  const auto j = canonical_structure<Square>(2 * n, n);
  map.m.assign(m.data(), m.data() + m.size());
  Square defect = congruent(m, j) - j;
  if (dynamics.forced > 0) {
    Square projector(2 * n, 2 * n);
    if (!dynamics.tangent_projector(plan.start, start, span_of(projector))) {
      map.status = FlowStatus::kStepFailed;
    }
    defect = congruent(projector, defect);
  }
  map.defect = defect.cwiseAbs().maxCoeff();
  map.relative_defect = map.defect / std::max(1.0, m.squaredNorm());
  return map;
}

}  // namespace carnot
