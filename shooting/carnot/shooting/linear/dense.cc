#include "carnot/shooting/linear/dense.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "carnot/numerics/lu.h"
#include "carnot/shooting/linear/known_size.h"

namespace carnot::internal {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Sums entry by entry: 0.07 to 0.9 us for 8 to 24 rows, where Eigen's product for large matrices
// takes 0.09 to 0.6 us and the compiler another second for each. The flows beside them take 10 us
// and more.
MatrixXd product(const MatrixXd& a, const MatrixXd& b) { return a.lazyProduct(b); }

MatrixXd transposed_product(const MatrixXd& a, const MatrixXd& b) {
  return a.transpose().lazyProduct(b);
}

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Row by row, as eliminate() takes them.
template <class M>
using Rows = Eigen::Matrix<double,
                           Eigen::Dynamic,
                           Eigen::Dynamic,
                           Eigen::RowMajor,
                           M::MaxRowsAtCompileTime,
                           M::MaxColsAtCompileTime>;

// A^-1 B; NaN where A is singular.
template <class M>
Rows<M> eliminate(Rows<M> a, Rows<M> b) {
  const int size = static_cast<int>(a.rows());
  if (!carnot::lu_solve(size, a.data(), static_cast<int>(b.cols()), b.data())) {
    b.setConstant(kNan);
  }
  return b;
}

// det of the permutations of a decomposition.
template <class Lu>
bool permutes_oddly(const Lu& lu) {
  return (lu.permutationP().determinant() < 0) != (lu.permutationQ().determinant() < 0);
}

}  // namespace

MatrixXd lu_solve(const MatrixXd& a, const MatrixXd& b) { return eliminate<MatrixXd>(a, b); }

MatrixXd lu_inverse(const MatrixXd& a) {
  return eliminate<MatrixXd>(a, MatrixXd::Identity(a.rows(), a.rows()));
}

SmallVector small_lu_solve(const SmallMatrix& a, const SmallVector& b) {
  const SmallMatrix x = eliminate<SmallMatrix>(a, b);
  return x.col(0);
}

SmallMatrix small_lu_inverse(const SmallMatrix& a) {
  return eliminate<SmallMatrix>(a, SmallMatrix::Identity(a.rows(), a.rows()));
}

std::optional<MatrixXd> inverse_if_regular(const MatrixXd& a, double threshold) {
  Eigen::FullPivLU<MatrixXd> lu(a);
  lu.setThreshold(threshold);
  if (!lu.isInvertible()) return std::nullopt;
  return lu_inverse(a);  // not lu.inverse(), whose triangles take the compiler longer
}

Determinant determinant_of(const MatrixXd& a) {
  const Eigen::FullPivLU<MatrixXd> lu(a);
  const VectorXd pivots = lu.matrixLU().diagonal();
  const bool negative = ((pivots.array() < 0).count() % 2 == 1) != permutes_oddly(lu);
  return {negative ? -1 : 1, pivots.array().abs().log().sum()};
}

namespace {

// Of all of Eigen's decompositions into an orthogonal and a triangular factor, the one for all
// purposes here: the exchange of columns costs little.
using Qr = Eigen::ColPivHouseholderQR<MatrixXd>;

// Q X, a reflection at a time. Eigen's own product takes them in blocks, for matrices of hundreds
// of rows, and takes the compiler as long as three decompositions.
MatrixXd times_q(const Qr& qr, MatrixXd x) {
  VectorXd work(x.cols());
  for (Eigen::Index k = qr.hCoeffs().size() - 1; k >= 0; --k) {
    const Eigen::Index rest = qr.rows() - k;
    x.bottomRows(rest).applyHouseholderOnTheLeft(
        qr.matrixQR().col(k).tail(rest - 1), qr.hCoeffs()[k], work.data());
  }
  return x;
}

// R of A = Q R, as many rows as columns.
MatrixXd r_of(const Qr& qr) {
  const MatrixXd triangle = qr.matrixQR().topRows(qr.cols()).triangularView<Eigen::Upper>();
  return MatrixXd(triangle * qr.colsPermutation().transpose());
}

using Svd = Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner>;

// Square matrices with the singular values and right singular vectors of A: R of its QR factors,
// or A with rows of zeros.
MatrixXd squared(const MatrixXd& a) {
  if (a.rows() > a.cols()) return r_of(Qr(a));
  MatrixXd padded = MatrixXd::Zero(a.cols(), a.cols());
  padded.topRows(a.rows()) = a;
  return padded;
}

}  // namespace

MatrixXd orthonormal(const MatrixXd& columns) {
  if (columns.rows() != 2 * columns.cols()) return qr_factors(columns).q;
  return with_known_size(columns.cols(), [&](auto known) -> MatrixXd {  // that of a plane
    KnownPlane<known> q = columns;
    KnownSquare<known> r;
    orthonormalise(q, r);
    return q;
  });
}

QrFactors qr_factors(const MatrixXd& columns) {
  QrFactors factors{columns, {}};
  orthonormalise(factors.q, factors.r);
  return factors;
}

std::optional<VectorXd> kernel_line(const MatrixXd& rows, double full_rank) {
  const Qr qr(rows.transpose());
  const VectorXd pivots = qr.matrixQR().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > full_rank * pivots.maxCoeff())) return std::nullopt;
  const auto size = rows.cols();
  return VectorXd(times_q(qr, VectorXd::Unit(size, size - 1)));
}

double spectral_radius(const MatrixXd& a) {
  const double scale = a.norm();
  if (!(scale > 0)) return scale;  // zero, or not a number
  MatrixXd power = a / scale;
  for (int k = 0; k < 4; ++k) power = product(power, power);
  // The products whose sum the last trace is may be too small for a double, their roots are not.
  const MatrixXd roots = power.cwiseAbs().cwiseSqrt();
  const double size = roots.cwiseProduct(roots.transpose()).maxCoeff();
  if (!(size > 0)) return 0;
  const auto n = static_cast<double>(a.rows());
  power /= size;
  const double mean16 = std::abs(power.trace()) / n;
  const double mean32 = std::abs(power.cwiseProduct(power.transpose()).sum()) / n;
  return scale * std::pow(size, 1.0 / 16) *
         std::max(std::pow(mean16, 1.0 / 16), std::pow(mean32, 1.0 / 32));
}

int count_below(const SmallMatrix& a, double bound) {
  constexpr double kClear = 1e-6;  // of a pivot, relative: eliminated with, it costs six digits
  const Eigen::Index n = a.rows();
  const double size = a.cwiseAbs().maxCoeff() + std::abs(bound);
  SmallMatrix rest = a;
  rest.diagonal().array() -= bound;
  int count = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double pivot = rest(k, k);
    if (!(std::abs(pivot) > kClear * size)) {
      return static_cast<int>((symmetric_eigen(a).values.array() < bound).count());
    }
    count += pivot < 0 ? 1 : 0;
    for (Eigen::Index i = k + 1; i < n; ++i) {
      const double factor = rest(i, k) / pivot;
      for (Eigen::Index j = k + 1; j < n; ++j) rest(i, j) -= factor * rest(k, j);
    }
  }
  return count;
}

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::Index n = a.rows();
  if (!a.allFinite()) return {VectorXd::Constant(n, kNan), MatrixXd::Constant(n, n, kNan)};
  return with_known_size(n, [&](auto known) {
    KnownSquare<known> rest = a;
    KnownSquare<known> vectors;
    diagonalise(rest, vectors);
    std::vector<Eigen::Index> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) {
      return rest(i, i) < rest(j, j);
    });
    SymmetricEigen eigen{VectorXd(n), MatrixXd(n, n)};
    for (Eigen::Index i = 0; i < n; ++i) {
      eigen.values[i] = rest(order[i], order[i]);
      eigen.vectors.col(i) = vectors.col(order[i]);
    }
    return eigen;
  });
}

VectorXd singular_values(const MatrixXd& a) {
  return right_singular(a).values.head(std::min(a.rows(), a.cols()));
}

RightSingular right_singular(const MatrixXd& a) {
  if (!a.allFinite()) {
    return {VectorXd::Constant(a.cols(), kNan), MatrixXd::Constant(a.cols(), a.cols(), kNan)};
  }
  const Svd svd(squared(a), Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixV()};
}

VectorXd least_squares(const MatrixXd& a, const VectorXd& b, double threshold) {
  const RightSingular right = right_singular(a);
  const MatrixXd images = product(a, right.vectors);  // orthogonal columns, as long as the values
  VectorXd parts = VectorXd::Zero(a.cols());
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    if (!(right.values[j] > threshold * right.values[0])) break;
    parts[j] = images.col(j).dot(b) / images.col(j).squaredNorm();
  }
  return right.vectors.lazyProduct(parts);
}

}  // namespace carnot::internal
