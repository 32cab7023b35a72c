#include "carnot/shooting/linear/lagrangian_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Phases phases_of(const MatrixXd& plane) {
  // Angles of combinations; one of them separates the eigenvalues.
  constexpr std::array kCombinations{0.7, 1.9, 2.6};
  constexpr double kCommon = 1e-9;
  const auto n = plane.cols();
  const auto x = plane.topRows(n);
  const auto p = plane.bottomRows(n);
  const MatrixXd real = product(p, p.transpose()) - product(x, x.transpose());
  const MatrixXd cross = product(p, x.transpose());
  const MatrixXd imaginary = cross + cross.transpose();
  Phases phases;
  double best = std::numeric_limits<double>::infinity();
  for (const double angle : kCombinations) {
    const MatrixXd v =
        symmetric_eigen(std::cos(angle) * real + std::sin(angle) * imaginary).vectors;
    const MatrixXd a = product(transposed_product(v, real), v);
    const MatrixXd b = product(transposed_product(v, imaginary), v);
    const double mixed = (a - MatrixXd(a.diagonal().asDiagonal())).cwiseAbs().maxCoeff() +
                         (b - MatrixXd(b.diagonal().asDiagonal())).cwiseAbs().maxCoeff();
    if (!(mixed < best)) continue;
    best = mixed;
    phases.angles.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) phases.angles[j] = std::atan2(b(j, j), a(j, j));
    if (mixed < kCommon) break;
  }
  std::sort(phases.angles.data(), phases.angles.data() + n, [](double a, double b) {
    return std::abs(a) < std::abs(b);
  });
  phases.turn = argument_of_determinant(p, x);
  return phases;
}

namespace {

// X P^-1 of a plane, and in how many directions it is infinite; the matrix is zero there.
struct Ratio {
  MatrixXd matrix;
  int infinite = 0;
};

// Where P b = 0, X b is orthogonal to what P spans, for the plane is Lagrangian. So X P^-1 is
// infinite along X b, and elsewhere it is X P^+ on the span of P.
Ratio ratio_of(const MatrixXd& x, const MatrixXd& p) {
  const MatrixXd ratio = product(x, lu_inverse(p));
  const bool regular = ratio.allFinite() && ratio.cwiseAbs().maxCoeff() < 1 / kRankRoundOff;
  if (regular) return {ratio};
  const RightSingular right = right_singular(p);
  const auto rank = (right.values.array() > kRankRoundOff * right.values[0]).count();
  const MatrixXd kept = right.vectors.leftCols(rank);
  const VectorXd sizes = right.values.head(rank);
  const MatrixXd span = product(p, kept) * sizes.cwiseInverse().asDiagonal();
  const MatrixXd image = product(x, kept) * sizes.cwiseInverse().asDiagonal();
  const MatrixXd projector = product(span, span.transpose());
  return {product(projector, product(image, span.transpose())), static_cast<int>(x.cols() - rank)};
}

}  // namespace

Graph graph_of(const MatrixXd& plane) {
  const auto n = plane.cols();
  const Ratio ratio = ratio_of(plane.topRows(n), plane.bottomRows(n));
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (ratio.matrix + ratio.matrix.transpose()));
  VectorXd root = eigen.values.cwiseAbs();
  const double largest = root.maxCoeff() > 0 ? root.maxCoeff() : 1;
  Graph graph;
  for (double& value : root) {
    if (value <= kRankRoundOff * largest) {
      ++graph.kernel;
      value = largest;
    }
  }
  graph.kernel -= ratio.infinite;
  graph.regularity = root.minCoeff() / largest;
  root = root.cwiseSqrt();
  graph.balance = product(eigen.vectors * root.asDiagonal(), eigen.vectors.transpose());
  return graph;
}

}  // namespace carnot::internal
