#include "carnot/shooting/shoot/on_wall.h"

#include <limits>
#include <stdexcept>

namespace carnot::internal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

WallAt wall_at(const Walls& walls, int n, int wall, const double* q) {
  std::vector<double> s(walls.size());
  std::vector<double> gradients(s.size() * n);
  std::vector<double> hessians(gradients.size() * n);
  walls.evaluate(q, s.data(), gradients.data(), hessians.data());
  const Eigen::Index size = n;
  return {
      s[wall],
      Eigen::Map<const VectorXd>(&gradients[static_cast<std::size_t>(wall) * n], size),
      Eigen::Map<const MatrixXd>(&hessians[static_cast<std::size_t>(wall) * n * n], size, size)};
}

Approach approach(HamiltonianTerms& terms, const WallAt& wall, const double* z) {
  const auto n = wall.gradient.size();
  terms.set(0, 0, z, z + n);
  Approach result;
  result.by_q.setZero(n);
  result.by_p.setZero(n);
  if (!terms.evaluate(1, HamiltonianTerms::Order::kSecond)) {
    result.rate = std::numeric_limits<double>::quiet_NaN();
    return result;
  }
  for (int a = 0; a < n; ++a) {
    result.rate += wall.gradient[a] * terms.by_p(0, a);
    for (int b = 0; b < n; ++b) {
      result.by_q[a] +=
          wall.hessian(a, b) * terms.by_p(0, b) + terms.qp(0, a, b) * wall.gradient[b];
      result.by_p[a] += terms.pp(0, a, b) * wall.gradient[b];
    }
  }
  return result;
}

Held::Held(const BoundaryValueProblem& problem, const Walls& walls, const BoundExtremal& extremal)
    : problem_(problem) {
  for (const Piece& piece : extremal.pieces) {
    if (piece.wall < 0 || scenes_.count(piece.wall) > 0) continue;
    const Limit& limit = problem.limits[walls[piece.wall].limit];
    if (!limit.held) {
      exists_ = false;
      return;
    }
    try {
      scenes_.emplace(piece.wall, limit.held());
    } catch (const std::invalid_argument&) {  // the rows are dependent there
      exists_ = false;
    }
  }
}

}  // namespace carnot::internal
