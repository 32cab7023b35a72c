#include "carnot/shooting/linear/lagrangian_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "carnot/shooting/linear/dense.h"
#include "carnot/shooting/linear/known_size.h"
#include "carnot/shooting/linear/round_off.h"

namespace carnot::internal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd phases_of(const MatrixXd& plane) {
  // Angles of combinations; one of them separates the eigenvalues.
  constexpr std::array kCombinations{0.7, 1.9, 2.6};
  constexpr double kCommon = 1e-9;
  VectorXd angles = VectorXd::Constant(plane.cols(), std::numeric_limits<double>::quiet_NaN());
  with_known_size(plane.cols(), [&](auto known) {
    using Square = KnownSquare<known>;
    const auto n = plane.cols();
    const Square x = plane.topRows(n);
    const Square p = plane.bottomRows(n);
    const Square real = Square(p.lazyProduct(p.transpose())) - x.lazyProduct(x.transpose());
    const Square cross = p.lazyProduct(x.transpose());
    const Square imaginary = cross + cross.transpose();
    Square v;
    double best = std::numeric_limits<double>::infinity();
    for (const double angle : kCombinations) {
      Square combined = std::cos(angle) * real + std::sin(angle) * imaginary;
      diagonalise(combined, v);
      const Square a = v.transpose().lazyProduct(Square(real.lazyProduct(v)));
      const Square b = v.transpose().lazyProduct(Square(imaginary.lazyProduct(v)));
      double mixed = 0;
      for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index i = 0; i < j; ++i) {
          mixed = std::max({mixed, std::abs(a(i, j)), std::abs(b(i, j))});
        }
      }
      if (!(mixed < best)) continue;
      best = mixed;
      for (Eigen::Index j = 0; j < n; ++j) angles[j] = std::atan2(b(j, j), a(j, j));
      if (mixed < kCommon) break;
    }
  });
  std::sort(
      angles.begin(), angles.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  return angles;
}

MatrixXd image_of(const MatrixXd& map, const Balance& balance, double c, const MatrixXd& plane) {
  return with_known_size(plane.cols(), [&](auto known) -> MatrixXd {
    using Square = KnownSquare<known>;
    using Plane = KnownPlane<known>;
    const auto n = plane.cols();
    const Square s = balance.s;
    const Square inverse = balance.inverse;
    Plane image(2 * n, n);
    image.topRows(n) = c * Square(s.lazyProduct(plane.topRows(n)));
    image.bottomRows(n) = Square(inverse.lazyProduct(plane.bottomRows(n))) / c;
    const Plane moved = map.lazyProduct(image);
    image.topRows(n) = Square(inverse.lazyProduct(moved.topRows(n))) / c;
    image.bottomRows(n) = c * Square(s.lazyProduct(moved.bottomRows(n)));
    Square r;
    orthonormalise(image, r);
    return image;
  });
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
